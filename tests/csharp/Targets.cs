// What csharp_client.py asks of ObliqStream.cs about targets, a line of output for each answer.
using System;
using System.Globalization;
using System.Linq;
using System.Threading.Tasks;
using Obliq;

static class Targets
{
    static Fields At(ulong id, double latitude_deg, double longitude_deg)
    {
        return new Fields().Add("id", id).Add("latitude_deg", latitude_deg).Add("longitude_deg", longitude_deg);
    }
    static Fields Truck() { return At(1, 33.027, -99.488).Add("type", "truck").Add("rcs_dbsm", 60.0); }

    static async Task TryAsync(string what, Func<Task> ask)
    {
        try { await ask(); }
        catch (ObliqException e) { Console.WriteLine(what + ": " + e.Message); }
    }

    static string Text(FormattableString text) { return text.ToString(CultureInfo.InvariantCulture); }

    static async Task ListAsync(ObliqStream stream, string what)
    {
        var all = await stream.GetTargetsAsync();
        Console.WriteLine(what + " " + all.Count);
        foreach (var t in all)
            Console.WriteLine(Text($"{t.id} '{t.name}' {t.type} {t.latitude_deg} {t.longitude_deg} {t.height_m} {t.height_reference} {t.rcs_dbsm} dBsm {t.swerling} ") +
                              Text($"north {t.velocity_north_m_s} valid {t.valid_s} route {(t.route == null ? 0 : t.route.latitude_deg.Length)}"));
    }

    static async Task Mistakes(ObliqStream stream)
    {
        await TryAsync("twice", () => stream.SetTargetsAsync(At(9, 33, -99), At(9, 33, -99)));
        await TryAsync("no id", () => stream.SetTargetsAsync(new Fields().Add("latitude_deg", 33.0)));
        await TryAsync("NaN", () => stream.SetTargetsAsync(At(9, double.NaN, -99)));
        await TryAsync("route of NaN", () => stream.SetTargetsAsync(At(9, 33, -99).Add("route", new Fields()
            .Add("latitude_deg", new[] { double.NaN }).Add("longitude_deg", new[] { -99.0 }).Add("speed_m_s", new[] { 5.0 }))));
        await TryAsync("type", () => stream.SetTargetsAsync(At(9, 33, -99).Add("type", "tank")));
        await TryAsync("too many", () => stream.SetTargetsAsync(Enumerable.Range(1, 2001).Select(k => At((ulong)k, 33, -99)).ToArray()));
        await TryAsync("too long", () => stream.SetTargetsAsync(At(9, 33, -99), At(10, 33, -99).Add("name", new string('x', 70000))));
        await TryAsync("swerling", () => stream.SetTargetsAsync(At(9, 33, -99).Add("swerling", 7)));
        await TryAsync("id", () => stream.SetTargetsAsync(new Fields().Add("id", -1)));
    }

    static void Print(string what, Frame frame)
    {
        int bins = frame.Target.Count(id => id == 1);
        Console.WriteLine(what + " " + (frame.Targets == null ? "no" : frame.Targets.Length.ToString()) + " targets, in bins " + bins);
        foreach (var t in frame.Targets ?? new TargetTruth[0])
            Console.WriteLine(Text($"truth {t.Id} {t.Latitude_deg:F6} {t.Longitude_deg:F6} {t.Height_m:F3} bearing {t.Bearing_deg:F4} range {t.Range_m:F2} ") +
                              Text($"elevation {t.Elevation_deg:F3} snr {t.Snr_db:F2} rcs {t.Rcs_dbsm:F2} seen {t.ShareSeen:F3} bin {t.AzimuthBin} {t.RangeBin} by {t.HiddenBy} power {t.IsPower}"));
    }

    static async Task<Frame> NextAsync(ObliqStream stream)
    {
        Frame frame;
        while (!stream.TryTakeFrame(out frame))
        {
            if (stream.End != null) throw stream.End;
            await Task.Delay(5);
        }
        return frame;
    }

    public static async Task Run(string url, string radar, string token, string viewers)
    {
        using (var viewer = await ObliqStream.ConnectAsync(url, viewers, "viewer"))
        using (var stream = await ObliqStream.ConnectAsync(url, token, "host"))
        {
            Console.WriteLine("may have truth: " + stream.Welcome.truth + ", the viewer: " + viewer.Welcome.truth);
            await TryAsync("unclaimed", () => stream.SetTargetsAsync(Truck()));
            await stream.ClaimTargetsAsync();
            await stream.SetTargetsAsync(Truck().Add("sim_time_ns", 5L).Add("name", "\u00e9clair \"1\""),
                At(2, 33.03, -99.46).Add("height_m", 900.0).Add("height_reference", "DATUM").Add("velocity_north_m_s", 12.0).Add("valid_s", 1000.0),
                At(ulong.MaxValue, 33.0, -99.45).Add("route", new Fields().Add("latitude_deg", new[] { 33.01, 33.02 })
                    .Add("longitude_deg", new[] { -99.4, -99.3 }).Add("speed_m_s", new[] { 10.0 }).Add("loops", true)));
            await ListAsync(stream, "set");
            await Mistakes(stream);
            Console.WriteLine("late: " + string.Join(", ", (await stream.SetTargetsAsync(Truck().Add("sim_time_ns", 4L))).warnings));
            await stream.RemoveTargetsAsync(Enumerable.Range(100, 10000).Select(k => (ulong)k).Concat(new[] { 2ul }).ToArray());
            await ListAsync(stream, "left");
            var many = Enumerable.Range(1, 2000).Select(k => At((ulong)k, 33.0, -99.0).Add("name", "a target with a name that takes some room: " + k));
            await stream.ReplaceTargetsAsync(many.ToArray());
            var all = await stream.GetTargetsAsync();
            Console.WriteLine("many " + all.Count + " " + all.Last().name);
            await stream.ReplaceTargetsAsync(Truck(), At(8, 30.0, -99.45).Add("swerling", 0));

            await stream.SubscribeWithTruthAsync(radar, 20, "TARGET");
            Print("frame", await NextAsync(stream));
            await stream.UnsubscribeAsync(radar);
            Print("rendered", await stream.RenderWithTargetsAsync(radar, null, new Fields().Add("azimuth_bins", 18), "TARGET"));
            Print("bare", await stream.RenderAsLiveAsync(radar, null, null, "TARGET"));

            await TryAsync("viewer", () => viewer.SubscribeWithTruthAsync(radar, 20, "VIDEO"));
            await TryAsync("viewer", () => viewer.SubscribeAsync(radar, 20, "TARGET"));
            await TryAsync("viewer", () => viewer.GetTargetsAsync());
            var unlabelled = await viewer.RenderWithTargetsAsync(radar, null, null, "VIDEO");
            var empty = await viewer.RenderAsLiveAsync(radar, null, null, "VIDEO");
            Console.WriteLine("viewer sees echoes: " + !unlabelled.Video.SequenceEqual(empty.Video) + ", truth: " + (unlabelled.Targets != null));
            await stream.ClearTargetsAsync();
            await ListAsync(stream, "cleared");
            await stream.ReleaseTargetsAsync();
            await TryAsync("released", () => stream.ClearTargetsAsync());
            await TryAsync("unknown plane", () => stream.SubscribeAsync(radar, 20, "TARGETS"));
        }
    }

    // Of a radar that turns: a pass has the target once, in the dwell that sees it.
    public static async Task RunPass(string url, string radar, string token)
    {
        using (var stream = await ObliqStream.ConnectAsync(url, token))
        {
            await stream.ClaimTargetsAsync();
            await stream.ReplaceTargetsAsync(Truck());
            await stream.SubscribeWithTruthAsync(radar, 20, "TARGET");
            for (int passes = 0; passes < 2; ++passes)
            {
                var frame = await NextAsync(stream);
                var at = frame.Targets.Length == 1 ? frame.Targets[0] : new TargetTruth();
                Console.WriteLine("pass: " + frame.Targets.Length + " target, its bin says " + frame.Target[at.AzimuthBin * frame.RangeBins + at.RangeBin]);
            }
            await stream.ClearTargetsAsync();
        }
    }
}
