// What csharp_client.py asks of ObliqStream.cs, a line of output for each answer.
//   Probe.exe URL RADAR TOKEN|-
using System;
using System.Linq;
using System.Security.Cryptography;
using System.Threading.Tasks;
using Obliq;

static class Probe
{
    static string Sum(byte[] bytes)
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
            await stream.UnsubscribeAsync(radar);
            try { await stream.SetPoseAsync(radar, new Fields().Add("bearing_deg", 1.0)); }
            catch (ObliqException e) { Console.WriteLine("refused " + e.Number); }
            await stream.ClaimAsync(radar);
            await stream.SetPoseAsync(radar, new Fields().Add("bearing_deg", 0.0).Add("pose_id", 9007199254740993L));
            var info = await stream.GetRadarAsync(radar);
            Console.WriteLine("bearing " + info.pose.bearing_deg + " pose_id " + info.pose.pose_id + " mine " + info.controlled_by_you);
            var ack = await stream.SetSettingsAsync(radar, new Fields().Add("r_max_m", 6000.0));
            Console.WriteLine("settings " + ack.settings_version + " " + (await stream.GetRadarAsync(radar)).settings.r_max_m);
            try { await stream.SetPoseAsync(radar, new Fields().Add("latitude_deg", 95.0).Add("bearing_deg", double.NaN)); }
            catch (ObliqException e) { Console.WriteLine(e.Message); }
            try { await stream.SetPoseAsync(radar, new Fields().Add("bering_deg", 1.0)); }
            catch (ObliqException e) { Console.WriteLine(e.Message); }
            try { await stream.GetRadarAsync(radar); }
            catch (ObliqException e) { Console.WriteLine("ended by " + e.Number); }
        }
    }

    static int Main(string[] args)
    {
        try
        {
            Run(args[0], args[1], args[2] == "-" ? null : args[2]).Wait();
            return 0;
        }
        catch (AggregateException e)
        {
            Console.WriteLine("failed: " + e.Flatten().InnerException);
            return 1;
        }
    }
}
