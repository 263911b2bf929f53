// What csharp_client.py asks of ObliqStream.cs, a line of output for each answer.
//   Probe.exe URL RADAR TOKEN|- [turning LATITUDE LONGITUDE HEIGHT | targets VIEWERS_TOKEN | pass]
using System;
using System.Linq;
using System.Security.Cryptography;
using System.Threading.Tasks;
using Obliq;

static class Probe
{
    public static string Sum(byte[] bytes)
    {
        using (var sha = SHA256.Create()) return string.Concat(sha.ComputeHash(bytes).Select(b => b.ToString("x2")));
    }

    static byte[] BytesOf(float[] values)
    {
        var bytes = new byte[4 * values.Length];
        Buffer.BlockCopy(values, 0, bytes, 0, bytes.Length);
        return bytes;
    }

    static async Task Run(string url, string radar, string token)
    {
        using (var stream = await ObliqStream.ConnectAsync(url, token, "probe \"quoted\""))
        {
            Console.WriteLine("welcome " + stream.Welcome.server_name + " " + string.Join(",", stream.Welcome.radars) + " " + stream.Welcome.role);
            await stream.SubscribeAsync(radar, 20, "VIDEO", "IQ", "STATE");
            Frame frame;
            while (!stream.TryTakeFrame(out frame)) await Task.Delay(10);
            Console.WriteLine("frame " + frame.AzimuthBins + " " + frame.RangeBins);
            Console.WriteLine("video " + Sum(frame.Video));
            Console.WriteLine("iq " + Sum(BytesOf(frame.Iq)));
            Console.WriteLine("state " + Sum(frame.State));
            var labels = await stream.RenderAsLiveAsync(radar, new Fields(), new Fields(), "MATERIAL", "BUILDING", "HEIGHT", "RETURNS");
            Console.WriteLine("labels " + Sum(labels.Material) + " " + Sum(BytesOf(labels.Building)) + " " + Sum(BytesOf(labels.Height_m)) + " " +
                              Sum(labels.Returns));
            for (int frames = 0; frames < 4; await Task.Delay(10))
                if (stream.TryTakeFrame(out frame)) ++frames;
            await stream.UnsubscribeAsync(radar);
            int rows = 0;
            for (Dwell dwell; stream.TryTakeDwell(out dwell);) rows += dwell.AzimuthCount;
            Console.WriteLine("rows kept for late takers " + rows);
            try { await stream.SetPoseAsync(radar, new Fields().Add("bearing_deg", 1.0)); }
            catch (ObliqException e) { Console.WriteLine("refused " + e.Number); }
            await stream.ClaimAsync(radar);
            await stream.SetPoseAsync(radar, new Fields().Add("bearing_deg", 0.0).Add("pose_id", 9007199254740993L));
            var info = await stream.GetRadarAsync(radar);
            Console.WriteLine("bearing " + info.pose.bearing_deg + " pose_id " + info.pose.pose_id + " mine " + info.controlled_by_you);
            var ack = await stream.SetSettingsAsync(radar, new Fields().Add("r_max_m", 6000.0));
            Console.WriteLine("settings " + ack.settings_version + " " + (await stream.GetRadarAsync(radar)).settings.r_max_m);
            await Integers(stream, radar);
            var knobs = await stream.GetSettingsAsync(radar);
            Console.WriteLine("knobs " + knobs["receiver_gain_db"] + " " + knobs["noise"] + " " + knobs["beam_pattern"] + " " + knobs["planes_per_bin"] +
                              " " + knobs["speckle_seed"]);
            var alike = await stream.RenderAsLiveAsync(radar, new Fields().Add("bearing_deg", 5.0), new Fields().Add("azimuth_bins", 16L), "STATE");
            Console.WriteLine("as live " + alike.AzimuthBins + " " + alike.RangeBins + " " + alike.Descriptor.settings.pixel_columns + " " +
                              alike.Descriptor.settings.r_max_m + " " + alike.Descriptor.pose.bearing_deg);
            await stream.BookmarkAsync("sch\u00f6n \"here\"");
            var marks = (await stream.GetEventsAsync()).Where(e => e.kind == "BOOKMARK_EVENT").ToList();
            Console.WriteLine("marks " + marks.Count + " " + (marks[0].text == "sch\u00f6n \"here\"") + " " + marks[0].by.StartsWith("probe"));
            try { await stream.BookmarkAsync(""); }
            catch (ObliqException e) { Console.WriteLine(e.Message); }
            try { await stream.SetPoseAsync(radar, new Fields().Add("latitude_deg", 95.0).Add("bearing_deg", double.NaN)); }
            catch (ObliqException e) { Console.WriteLine(e.Message); }
            try { await stream.SetPoseAsync(radar, new Fields().Add("bering_deg", 1.0)); }
            catch (ObliqException e) { Console.WriteLine(e.Message); }
            try { await stream.GetRadarAsync(radar); }
            catch (ObliqException e) { Console.WriteLine("ended by " + e.Number); }
        }
    }

    // Integers that are none: refused before anything is sent, so the connection stays.
    static void TryInteger(Action add)
    {
        try { add(); }
        catch (ObliqException e) { Console.WriteLine(e.Message); }
    }

    static async Task Integers(ObliqStream stream, string radar)
    {
        TryInteger(() => new Fields().Add("azimuth_bins", 1.5));
        TryInteger(() => new Fields().Add("range_bins", 4294967295L));
        TryInteger(() => new Fields().Add("range_bins", 1e12));
        TryInteger(() => new Fields().Add("speckle_seed", double.NaN));
        TryInteger(() => new Fields().Add("noise_frame", -1L));
        TryInteger(() => new Fields().Add("pixel_rows", "12x"));
        TryInteger(() => new Fields().Add("adc_bits", 1e-40));
        await stream.SetSettingsAsync(radar, new Fields().Add("azimuth_bins", 40.0).Add("speckle_seed", 1e17).Add("r_min_m", 2500L));
        var settings = (await stream.GetRadarAsync(radar)).settings;
        Console.WriteLine("integers " + settings.azimuth_bins + " " + settings.r_min_m + " " + (stream.End == null));
    }

    static async Task Turn(string[] args)
    {
        var place = args.Skip(4).Select(text => double.Parse(text, System.Globalization.CultureInfo.InvariantCulture)).ToArray();
        using (var stream = await ObliqStream.ConnectAsync(args[0], args[2]))
            await new Turning(stream, args[1]).RunAsync(
                new Fields().Add("latitude_deg", place[0]).Add("longitude_deg", place[1]).Add("height_m", place[2]).Add("bearing_deg", 20.0),
                new Fields().Add("frustum", "SWEEP").Add("pixel_columns", 144L).Add("pixel_rows", 64L).Add("sector_deg", 360.0)
                    .Add("r_min_m", 2000.0).Add("r_max_m", 5000.0).Add("azimuth_bins", 72L).Add("range_bins", 32L));
    }

    static int Main(string[] args)
    {
        try
        {
            var what = args.Length > 3 ? args[3] : "";
            if (what == "turning") Turn(args).Wait();
            else if (what == "targets") Targets.Run(args[0], args[1], args[2], args[4]).Wait();
            else if (what == "pass") Targets.RunPass(args[0], args[1], args[2]).Wait();
            else Run(args[0], args[1], args[2] == "-" ? null : args[2]).Wait();
            return 0;
        }
        catch (AggregateException e)
        {
            Console.WriteLine("failed: " + e.Flatten().InnerException);
            return 1;
        }
    }
}
