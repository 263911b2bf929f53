// What csharp_client.py asks of ObliqStream.cs about a radar that turns, a line of output for each answer.
using System;
using System.Collections.Generic;
using System.Linq;
using System.Threading.Tasks;
using Obliq;

sealed class Turning
{
    readonly ObliqStream stream_;
    readonly string radar_;
    readonly Queue<Dwell> taken_ = new Queue<Dwell>();  // from the stream, not yet looked at

    public Turning(ObliqStream stream, string radar) { stream_ = stream; radar_ = radar; }

    // Without an end the test would say nothing; its harness has a time limit.
    async Task<Dwell> NextAsync()
    {
        Dwell dwell;
        if (taken_.Count > 0) return taken_.Dequeue();
        while (!stream_.TryTakeDwell(out dwell))
        {
            if (stream_.End != null) throw stream_.End;
            await Task.Delay(1);
        }
        return dwell;
    }

    static byte[] Row(Array plane, Frame frame, int azimuth)
    {
        var row = new byte[frame.RangeBins];
        Buffer.BlockCopy(plane, azimuth * row.Length, row, 0, row.Length);
        return row;
    }

    // The picture's states at a moment when the beam has not reached its last quarter; of the next pass that has one.
    async Task<KeyValuePair<Frame, byte[]>> BeforeTheLastQuarterAsync(Frame notThis)
    {
        while (true)
        {
            Dwell dwell;
            do dwell = await NextAsync(); while (dwell.Picture == notThis || dwell.Picture.State == null);
            var states = (byte[])dwell.Picture.State.Clone();
            Dwell later;
            while (stream_.TryTakeDwell(out later)) taken_.Enqueue(later);
            if (taken_.Concat(new[] { dwell }).All(d => d.FirstAzimuth + d.AzimuthCount <= 3 * d.Picture.AzimuthBins / 4))
                return new KeyValuePair<Frame, byte[]>(dwell.Picture, states);
            notThis = dwell.Picture;
        }
    }

    // Rows of the last quarter that are as `other` has them, and those that hold nothing.
    static string LastQuarter(Frame frame, byte[] states, Frame other)
    {
        int rows = frame.AzimuthBins, same = 0, empty = 0;
        for (int a = 3 * rows / 4; a < rows; ++a)
        {
            var row = Row(states, frame, a);
            if (other != null && row.SequenceEqual(Row(other.State, other, a))) ++same;
            if (row.All(state => state == 0)) ++empty;
        }
        return same + " as before, " + empty + " empty of " + rows / 4;
    }

    public async Task RunAsync(Fields pose, Fields settings)
    {
        var once = await stream_.RenderOnceAsync(radar_, pose, settings, "VIDEO", "STATE");
        Console.WriteLine("once " + once.AzimuthBins + " " + once.RangeBins + " " + (once.Scan == null ? "whole" : once.Scan.mode));
        Console.WriteLine("video " + Probe.Sum(once.Video));
        Console.WriteLine("state " + Probe.Sum(once.State));
        try { await stream_.RenderOnceAsync(radar_, new Fields().Add("latitude_deg", 33.0), settings, "VIDEO"); }
        catch (ObliqException e) { Console.WriteLine("refused " + e.Number + " " + string.Join(",", e.Fields.Select(f => f.field))); }

        await stream_.SubscribeAsync(radar_, 10, "VIDEO", "STATE");
        var first = await BeforeTheLastQuarterAsync(null);
        Console.WriteLine("first pass: " + LastQuarter(first.Key, first.Value, null) + " " + first.Key.Scan.mode);

        int others = 0, dwells = 0;
        long beam_ns = 0;
        Dwell dwell;
        for (; (dwell = await NextAsync()).Picture == first.Key; ++dwells)
        {
            if (dwell.BeamNs == 0) continue;  // what the pass has missed
            if (dwell.BeamNs < beam_ns || dwell.Pose.latitude_deg != 33.0) throw new Exception("the beam's time or pose is wrong");
            beam_ns = dwell.BeamNs;
            bool video = dwell.Plane == "VIDEO";
            for (int a = dwell.FirstAzimuth; a < dwell.FirstAzimuth + dwell.AzimuthCount; ++a)
                if (!Row(video ? dwell.Picture.Video : dwell.Picture.State, once, a).SequenceEqual(Row(video ? once.Video : once.State, once, a)))
                    ++others;
        }
        taken_.Enqueue(dwell);
        Console.WriteLine(others + " rows unlike those of the whole frame" + (dwells > 1 ? "" : ", of one dwell"));

        Frame whole;
        Console.WriteLine("the pass is " + (stream_.TryTakeFrame(out whole) && whole == first.Key ? "whole" : "not whole"));
        var second = await BeforeTheLastQuarterAsync(first.Key);
        Console.WriteLine("next pass: " + LastQuarter(second.Key, second.Value, first.Key));
        await TurnAsync();
        await MissAsync();
        await SwitchAsync();
    }

    // The antenna itself turns: rows say where they were seen.
    async Task TurnAsync()
    {
        await stream_.ClaimAsync(radar_);
        await stream_.SetPoseAsync(radar_, new Fields().Add("bearing_deg", 40.0));
        Dwell dwell;
        do dwell = await NextAsync(); while (dwell.Pose.bearing_deg != 40.0 || dwell.BeamNs == 0);
        var bearings = dwell.Picture.Bearings_deg;
        var seen = new[] { 20.0, 40.0 }.Select(bearing => bearings.Where((b, a) => b == bearing - 180 + 5 * a).Count());
        Console.WriteLine("bearings: " + (seen.All(n => n > 0) && seen.Sum() == bearings.Length ? "as seen" : string.Join(" ", bearings)));
    }

    // The daemon stands still for a while when this asks for it: what the beam passed then must be dark, and be told.
    async Task MissAsync()
    {
        var pass = await BeforeTheLastQuarterAsync((await NextAsync()).Picture);
        Console.WriteLine("stop");
        Console.ReadLine();
        var told = new HashSet<int>();
        var frame = pass.Key;
        Dwell dwell;
        while ((dwell = await NextAsync()).Picture == frame)
            if (dwell.BeamNs == 0)
                for (int a = 0; a < dwell.AzimuthCount; ++a) told.Add(dwell.FirstAzimuth + a);
        var dark = Enumerable.Range(0, frame.AzimuthBins).Where(a => Row(frame.State, frame, a).All(state => state == 0));
        Console.WriteLine("missed: " + (told.Count > 0 ? "some" : "none") + ", told " + (told.SetEquals(dark) ? "all" : "others"));
    }

    async Task SwitchAsync()
    {
        await stream_.SetStateAsync(radar_, freeze: true);
        var info = await stream_.GetRadarAsync(radar_);
        Console.WriteLine("frozen " + info.frozen + " silent " + info.transmit_off);
        await stream_.SetStateAsync(radar_, transmit: false, freeze: false);
        info = await stream_.GetRadarAsync(radar_);
        Console.WriteLine("frozen " + info.frozen + " silent " + info.transmit_off);
        await stream_.SetStateAsync(radar_, true);
        Console.WriteLine("silent " + (await stream_.GetRadarAsync(radar_)).transmit_off);
    }
}
