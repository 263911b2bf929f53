// A client of obliqd in one file, without packages: for .NET, Mono and Unity (2021 or later). The stream over a
// WebSocket, subprotocol obliq.v1.json, as proto/PROTOCOL.md, "WebSocket", has it. One file, though a long one: it is
// copied into projects.
//
//   var radar = await ObliqStream.ConnectAsync("ws://127.0.0.1:7480/stream");
//   await radar.SubscribeAsync("main", 30, "VIDEO");
//   ... in every turn of the loop:  while (radar.TryTakeDwell(out var dwell)) picture = dwell.Picture.Video;
//
// Requests may come from any thread; each task ends when the server has answered, with an ObliqException when it
// refused. What arrives waits until it is taken: of whole frames the newest, of dwells two turns of the antenna.
using System;
using System.Collections.Concurrent;
using System.Collections.Generic;
using System.Globalization;
using System.IO;
using System.Net.WebSockets;
using System.Text;
using System.Threading;
using System.Threading.Tasks;
#if UNITY_5_3_OR_NEWER
using UnityEngine;
#else
using System.Runtime.Serialization;
using System.Runtime.Serialization.Json;
#endif

#pragma warning disable 649  // members that only the readers of JSON assign

namespace Obliq
{
#if UNITY_5_3_OR_NEWER
    // JsonUtility wants [Serializable] and public fields; DataContractJsonSerializer wants these.
    [AttributeUsage(AttributeTargets.Class)] internal sealed class DataContractAttribute : Attribute { }
    [AttributeUsage(AttributeTargets.Field)] internal sealed class DataMemberAttribute : Attribute { }
#endif

    // ---- What the server says: fields as in obliq.proto; what is absent has its default, 64-bit numbers are texts ----

    [Serializable, DataContract]
    public sealed class Welcome
    {
        [DataMember] public string server_name, server_version, scene_name, role, client_name;
        [DataMember] public string[] radars;
        [DataMember] public bool truth;  ///< this client may be told where targets are
    }

    [Serializable, DataContract]
    public sealed class Pose
    {
        [DataMember] public double latitude_deg, longitude_deg, height_m, bearing_deg, tilt_deg, heading_deg, roll_deg, pitch_deg, time_rate;
        [DataMember] public double velocity_north_m_s, velocity_east_m_s, velocity_up_m_s; ///< of the antenna; 0 also where it is not known
        [DataMember] public string height_reference, pose_id, sim_time_ns;
    }

    /// <summary>Those that place and scale a frame; add members by the names of obliq.proto as you need them.</summary>
    [Serializable, DataContract]
    public sealed class RadarSettings
    {
        [DataMember] public double frequency_ghz, power_w, gain_db, sector_deg, r_min_m, r_max_m, video_span_db, scan_rate_deg_s;
        [DataMember] public int azimuth_bins, range_bins, pixel_columns, pixel_rows;
        [DataMember] public string frustum, scan_mode;
    }

    [Serializable, DataContract]
    public sealed class RadarInfo
    {
        [DataMember] public string request_id, radar, controller, settings_controller, fault, gimbal, settings_version;
        [DataMember] public RadarSettings settings;
        [DataMember] public Pose pose;
        [DataMember] public bool controlled_by_you, transmit_off, frozen, exercise_frozen, pose_stale;
    }

    [Serializable, DataContract]
    public sealed class Ack { [DataMember] public string request_id, settings_version; [DataMember] public string[] warnings; }

    /// <summary>Who changed what of the exercise, and when: kind "BOOKMARK_EVENT", "SETTINGS_EVENT" and so on, as EventKind in obliq.proto.</summary>
    [Serializable, DataContract]
    public sealed class ExerciseEvent { [DataMember] public string number, utc_ns, kind, by, radar, text; }

    [Serializable, DataContract]
    internal sealed class ExerciseEvents
    {
        [DataMember] public ExerciseEvent[] events;
        [DataMember] public bool more;
    }

    /// <summary>A target of the world as it was set; what it has not is 0, of a route its points. See PROTOCOL.md, "Targets".</summary>
    [Serializable, DataContract]
    public sealed class Target
    {
        [DataMember] public string id, name, type, height_reference, sim_time_ns;  // height_reference absent: DATUM, as every enum's first
        [DataMember] public double latitude_deg, longitude_deg, height_m, geoid_undulation_m;
        [DataMember] public double velocity_north_m_s, velocity_east_m_s, velocity_up_m_s;
        [DataMember] public double acceleration_north_m_s2, acceleration_east_m_s2, acceleration_up_m_s2;
        [DataMember] public double heading_deg, heading_rate_deg_s, rcs_dbsm, length_m, width_m, top_m, valid_s, age_s;
        [DataMember] public int swerling;
        [DataMember] public TargetRoute route;
    }

    [Serializable, DataContract]
    public sealed class TargetRoute
    {
        [DataMember] public double[] latitude_deg, longitude_deg, height_m, speed_m_s;
        [DataMember] public bool loops;
    }

    [Serializable, DataContract]
    internal sealed class TargetList
    {
        [DataMember] public Target[] targets;
        [DataMember] public bool more;
    }

    [Serializable, DataContract]
    public sealed class FrameDescriptor
    {
        [DataMember] public string radar, frame_id, unit, power_unit;
        [DataMember] public RadarSettings settings;
        [DataMember] public Pose pose;
        [DataMember] public double origin_latitude_deg, origin_longitude_deg, antenna_x_m, antenna_y_m, antenna_z_m, north_rad;
        [DataMember] public double azimuth_start_deg, azimuth_width_deg, range_start_m, range_spacing_m;
        [DataMember] public double map_reference_height_m, wavelength_m, video_floor_db;
    }

    /// <summary>How a turning radar's beam moves in one pass: "SECTOR_SCAN" or "CIRCULAR_SCAN".</summary>
    [Serializable, DataContract]
    public sealed class ScanPass
    {
        [DataMember] public string mode, begin_ns;
        [DataMember] public bool clockwise;
        [DataMember] public double rate_deg_s;
        [DataMember] public int dwell_bins;
    }

    [Serializable, DataContract]
    internal sealed class FrameBegin
    {
        [DataMember] public string request_id;
        [DataMember] public FrameDescriptor frame;
        [DataMember] public ScanPass scan;
    }

    [Serializable, DataContract]
    internal sealed class WedgeBlock
    {
        [DataMember] public string plane, beam_ns;  // plane absent: IQ, as every enum's first
        [DataMember] public int first_azimuth, n_azimuth, first_range, n_range;
        [DataMember] public Pose pose;
    }

    [Serializable, DataContract]
    internal sealed class TargetBlock { [DataMember] public int records, record_bytes; }

    [Serializable, DataContract]
    internal sealed class AzimuthSpan { [DataMember] public int first_azimuth, n_azimuth; }

    [Serializable, DataContract]
    internal sealed class FrameEnd { [DataMember] public AzimuthSpan[] missed; }

    [Serializable, DataContract]
    internal sealed class FrameAbort { [DataMember] public string reason; }

    [Serializable, DataContract]
    internal sealed class Heartbeat { [DataMember] public string request_id; [DataMember] public bool answer_wanted; }

    [Serializable, DataContract]
    public sealed class FieldFault
    {
        [DataMember] public string field, found, allowed;
        public override string ToString() { return field + ": found " + found + "; allowed: " + allowed; }
    }

    [Serializable, DataContract]
    internal sealed class ErrorMessage
    {
        [DataMember] public string request_id, text;
        [DataMember] public int number;
        [DataMember] public FieldFault[] fields;
    }

    /// <summary>A refusal, or the end of the connection. Its text names each field, what was found and what is allowed.</summary>
    public sealed class ObliqException : Exception
    {
        public readonly int Number;  ///< of PROTOCOL.md, "Errors"; 0: the connection was lost
        public readonly FieldFault[] Fields;
        public ObliqException(int number, string text, FieldFault[] fields)
            : base("obliq error " + number + ": " + text + Listed(fields)) { Number = number; Fields = fields ?? new FieldFault[0]; }
        private static string Listed(FieldFault[] fields)
        {
            var text = "";
            foreach (var field in fields ?? new FieldFault[0]) text += "\n  " + field;
            return text;
        }
    }

    /// <summary>What hides a target, or part of it.</summary>
    public enum HiddenBy : byte { Nothing, Ground, Building, Horizon, UnknownGround }

    /// <summary>Where a target is in a frame, seen or not: PROTOCOL.md, "Truth".</summary>
    public struct TargetTruth
    {
        public ulong Id;
        public double Latitude_deg, Longitude_deg;  ///< of its foot, as the next
        public double Height_m;      ///< above the datum
        public double Bearing_deg;   ///< true, from the antenna, 0 to 360
        public double Range_m;       ///< slant range
        public float Elevation_deg;
        public float Closing_m_s;    ///< of target and antenna together; positive: the range falls
        public float Snr_db;         ///< in the middle of beam and pulse; -1000: nothing is seen
        public float Rcs_dbsm;       ///< as drawn for this look
        public float ShareSeen;      ///< 0 to 1
        public int AzimuthBin, RangeBin;  ///< that hold it; -1: none
        public HiddenBy HiddenBy;
        public bool IsPower;         ///< Snr_db is the echo's power in dBW: the receiver has no noise

        internal const int RecordBytes = 80;  // a later server's may be longer

        internal static TargetTruth Read(byte[] bytes, int at)
        {
            return new TargetTruth
            {
                Id = BitConverter.ToUInt64(bytes, at),
                Latitude_deg = BitConverter.ToDouble(bytes, at + 8),
                Longitude_deg = BitConverter.ToDouble(bytes, at + 16),
                Height_m = BitConverter.ToDouble(bytes, at + 24),
                Bearing_deg = BitConverter.ToDouble(bytes, at + 32),
                Range_m = BitConverter.ToDouble(bytes, at + 40),
                Elevation_deg = BitConverter.ToSingle(bytes, at + 48),
                Closing_m_s = BitConverter.ToSingle(bytes, at + 52),
                Snr_db = BitConverter.ToSingle(bytes, at + 56),
                Rcs_dbsm = BitConverter.ToSingle(bytes, at + 60),
                ShareSeen = BitConverter.ToSingle(bytes, at + 64),
                AzimuthBin = BitConverter.ToInt32(bytes, at + 68),
                RangeBin = BitConverter.ToInt32(bytes, at + 72),
                HiddenBy = (HiddenBy)bytes[at + 76],
                IsPower = bytes[at + 77] != 0
            };
        }
    }

    /// <summary>Bins of a radar. Azimuth is the slow index, range the fast one: bin (a, r) is at [a * RangeBins + r].</summary>
    public sealed class Frame
    {
        public FrameDescriptor Descriptor;
        public ScanPass Scan;  ///< of a turning radar, whose pass this is; null: all azimuths at once
        public int AzimuthBins { get { return Descriptor.settings.azimuth_bins; } }
        public int RangeBins { get { return Descriptor.settings.range_bins; } }
        public byte[] Video;  ///< 0: nothing; else 1 + 254 (dB - video_floor_db) / video_span_db; null when not asked for
        public byte[] State;  ///< 0 not sampled, 1 sampled, 2 shadow, 3 no surface, 4 no ground at this range
        public float[] Iq;    ///< real and imaginary parts in turn
        // Labels, of the ground's mean power in a bin:
        public byte[] Material;   ///< of the greatest sum of power, as the descriptor numbers them; 255: no power
        public float[] Building;  ///< share of power that walls and roofs give, 0 to 1
        public float[] Height_m;  ///< above the datum, weighed by power; NaN: no power
        public byte[] Returns;    ///< separate stretches of visible surface; above 1 is layover
        public uint[] Target;     ///< the strongest target in the bin: the last 32 bits of its id; 0: none
        /// <summary>Where targets are, where truth was asked for; null: not, or not yet. Of a pass those of the dwells that have come,
        /// each time in a new array.</summary>
        public volatile TargetTruth[] Targets;
        /// <summary>True bearing of each azimuth's left edge as it was seen: where the antenna itself turns, a pass's differ from
        /// azimuth_start_deg + a azimuth_width_deg. NaN: not seen yet.</summary>
        public double[] Bearings_deg;
        internal string Request;  // of a RenderOnce
        internal uint Stream;
        internal long BytesReceived;
        internal bool Continues;  // the pass before it

        // Of the planes that have come.
        internal long Bytes()
        {
            long bytes = 0;
            foreach (var name in Planes()) bytes += Buffer.ByteLength(Plane(name));
            return bytes;
        }

        internal Array Plane(string name)
        {
            int bins = AzimuthBins * RangeBins;
            if (name == "VIDEO") return Video ?? (Video = new byte[bins]);
            if (name == "STATE") return State ?? (State = new byte[bins]);
            if (name == "IQ") return Iq ?? (Iq = new float[2 * bins]);
            if (name == "BUILDING") return Building ?? (Building = new float[bins]);
            if (name == "RETURNS") return Returns ?? (Returns = new byte[bins]);
            if (name == "TARGET") return Target ?? (Target = new uint[bins]);
            if (name == "MATERIAL") return Material ?? (Material = Filled(new byte[bins], 0, bins, NoMaterial));
            return name == "HEIGHT" ? Height_m ?? (Height_m = Filled(new float[bins], 0, bins, float.NaN)) : null;
        }
        private const byte NoMaterial = 255;
        private static T[] Filled<T>(T[] values, int first, int count, T value)
        {
            for (int i = first; i < first + count; ++i) values[i] = value;
            return values;
        }
        internal List<string> Planes()
        {
            var planes = new List<string>();
            if (Video != null) planes.Add("VIDEO");
            if (State != null) planes.Add("STATE");
            if (Iq != null) planes.Add("IQ");
            if (Material != null) planes.Add("MATERIAL");
            if (Building != null) planes.Add("BUILDING");
            if (Height_m != null) planes.Add("HEIGHT");
            if (Returns != null) planes.Add("RETURNS");
            if (Target != null) planes.Add("TARGET");
            return planes;
        }
        internal static int BytesOfABin(string plane)
        {
            return plane == "IQ" ? 8 : plane == "BUILDING" || plane == "HEIGHT" || plane == "TARGET" ? 4 : 1;
        }
        // What is not looked at holds no echo (PROTOCOL.md, planes).
        internal void SetEmpty(string name, int firstAzimuth, int azimuths)
        {
            int first = firstAzimuth * RangeBins, count = azimuths * RangeBins, numbers = name == "IQ" ? 2 : 1;
            if (name == "MATERIAL") Filled(Material, first, count, NoMaterial);
            else if (name == "HEIGHT") Filled(Height_m, first, count, float.NaN);
            else Array.Clear(Plane(name), numbers * first, numbers * count);
        }
        internal void Seen(int first, int count, Pose pose)
        {
            double start_deg = Descriptor.azimuth_start_deg + (pose == null ? 0 : pose.bearing_deg - Descriptor.pose.bearing_deg);
            for (int a = first; a < first + count; ++a) Bearings_deg[a] = start_deg + a * Descriptor.azimuth_width_deg;
        }

        // A pass begins with what the one before it has shown.
        internal void ContinueFrom(Frame before)
        {
            FrameDescriptor d = Descriptor, b = before.Descriptor;
            if (before.Stream != Stream || before.AzimuthBins != AzimuthBins || before.RangeBins != RangeBins ||
                b.azimuth_width_deg != d.azimuth_width_deg || b.range_start_m != d.range_start_m ||
                b.range_spacing_m != d.range_spacing_m || b.video_floor_db != d.video_floor_db ||
                b.settings.video_span_db != d.settings.video_span_db) return;
            Video = before.Video == null ? null : (byte[])before.Video.Clone();
            State = before.State == null ? null : (byte[])before.State.Clone();
            Iq = before.Iq == null ? null : (float[])before.Iq.Clone();
            Material = before.Material == null ? null : (byte[])before.Material.Clone();
            Building = before.Building == null ? null : (float[])before.Building.Clone();
            Height_m = before.Height_m == null ? null : (float[])before.Height_m.Clone();
            Returns = before.Returns == null ? null : (byte[])before.Returns.Clone();
            Target = before.Target == null ? null : (uint[])before.Target.Clone();
            Bearings_deg = (double[])before.Bearings_deg.Clone();
            Continues = true;
        }
    }

    /// <summary>Azimuths that have just come: a turning radar's, or all of a whole frame.</summary>
    public sealed class Dwell
    {
        public Frame Picture;  ///< has these rows already; ahead of the beam are the rows of the pass before
        public string Plane;   ///< "VIDEO", "IQ", "STATE", "MATERIAL", "BUILDING", "HEIGHT", "RETURNS" or "TARGET"
        public int FirstAzimuth, AzimuthCount;
        public Pose Pose;      ///< the antenna's, when the beam stood there
        public long BeamNs;    ///< when that was, by the server's monotonic clock; 0: the radar does not turn
    }

    /// <summary>The JSON of a request. Only what is added is sent: with proto3's optional fields 0 is a value.</summary>
    public sealed class Fields
    {
        // The integers among the fields of RadarSettings, of Pose and of Target, as obliq.proto has them.
        private static readonly string[] Int32s = {
            "pixel_columns", "pixel_rows", "azimuth_bins", "range_bins", "scan_dwell_bins", "sub_columns",
            "beam_nbar", "pulse_nbar", "pulse_extent_bins", "adc_bits", "video_looks", "planes_per_bin",
            "doppler_pulses", "canceller", "swerling" };
        private static readonly string[] Int64s = {
            "speckle_seed", "noise_seed", "sim_time_ns" };
        private static readonly string[] Uint64s = {
            "noise_frame", "pose_id", "id" };
        private readonly StringBuilder text_ = new StringBuilder("{");

        // An integer that is none, or is too great for its field, is refused here, with an ObliqException.
        public Fields Add(string name, string value) { return value == null ? this : Put(name, Quoted(Checked(name, value, true))); }
        public Fields Add(string name, bool value) { return Put(name, value ? "true" : "false"); }
        public Fields Add(string name, long value)
        {
            return Put(name, Checked(name, value.ToString(CultureInfo.InvariantCulture), true));
        }
        public Fields Add(string name, ulong value)
        {
            return Put(name, Checked(name, value.ToString(CultureInfo.InvariantCulture), true));
        }
        public Fields Add(string name, double value)
        {
            return Put(name, Finished(value, Checked(name, TextOf(value), value == Math.Floor(value))));
        }
        public Fields Add(string name, Fields value) { return Put(name, value.ToString()); }
        public Fields Add(string name, IEnumerable<string> values)
        {
            var quoted = new List<string>();
            foreach (var value in values) quoted.Add(Quoted(value));
            return AddJson(name, quoted);
        }
        public Fields Add(string name, IEnumerable<double> values)
        {
            var texts = new List<string>();
            foreach (var value in values) texts.Add(Finished(value, TextOf(value)));
            return AddJson(name, texts);
        }
        internal Fields AddJson(string name, List<string> values) { return Put(name, "[" + string.Join(",", values.ToArray()) + "]"); }
        public override string ToString() { return text_ + "}"; }

        private static string TextOf(double value) { return value.ToString("R", CultureInfo.InvariantCulture).Replace("\u221E", "Infinity"); }
        // What is not finite is a text in JSON: "NaN", "Infinity", "-Infinity".
        private static string Finished(double value, string text)
        {
            return double.IsNaN(value) || double.IsInfinity(value) ? Quoted(text) : text;
        }

        private static string Checked(string name, string text, bool isWhole)
        {
            decimal least, most, whole;
            if (Array.IndexOf(Int32s, name) >= 0) { least = int.MinValue; most = int.MaxValue; }
            else if (Array.IndexOf(Int64s, name) >= 0) { least = long.MinValue; most = long.MaxValue; }
            else if (Array.IndexOf(Uint64s, name) >= 0) { least = 0; most = ulong.MaxValue; }
            else return text;
            isWhole &= decimal.TryParse(text, NumberStyles.Float, CultureInfo.InvariantCulture, out whole);
            if (isWhole && whole == decimal.Truncate(whole) && whole >= least && whole <= most)
                return whole.ToString("0", CultureInfo.InvariantCulture);  // 1E+15 as well
            var allowed = string.Format(CultureInfo.InvariantCulture, "a whole number from {0} to {1}", least, most);
            throw new ObliqException(100, "not sent", new[] { new FieldFault { field = name, found = text, allowed = allowed } });
        }

        private Fields Put(string name, string json)
        {
            text_.Append(text_.Length > 1 ? "," : "").Append(Quoted(name)).Append(':').Append(json);
            return this;
        }
        private static string Quoted(string value)
        {
            var quoted = new StringBuilder("\"");
            foreach (char c in value)
                if (c < ' ') quoted.Append("\\u").Append(((int)c).ToString("x4"));
                else quoted.Append(c == '"' || c == '\\' ? "\\" : "").Append(c);
            return quoted.Append('"').ToString();
        }
    }

    public sealed class ObliqStream : IDisposable
    {
        private const int HeaderBytes = 48;
        private const uint Magic = 0x514C424F;  // "OBLQ"
        private enum Type : ushort
        {
            Hello = 1, Welcome = 2, Ack = 3, Error = 4, Heartbeat = 5, GetRadar = 18, RadarInfo = 19, ClaimControl = 20,
            ReleaseControl = 21, SetSettings = 22, SetPose = 23, Subscribe = 24, Unsubscribe = 25, RenderOnce = 26, SetState = 29,
            SetTargets = 34, GetTargets = 35, ResetExercise = 37, SetExercise = 41, GetEvents = 42, AddBookmark = 44,
            FrameBegin = 48, WedgeBlock = 49, FrameEnd = 50, FrameAbort = 51, TargetBlock = 52
        }

        private readonly ClientWebSocket socket_ = new ClientWebSocket();
        private readonly CancellationTokenSource closing_ = new CancellationTokenSource();
        private readonly SemaphoreSlim sending_ = new SemaphoreSlim(1, 1);
        private readonly SemaphoreSlim settingTargets_ = new SemaphoreSlim(1, 1);  // the parts of one change follow each other
        // By request: a string, the answer's JSON; a Frame that a RenderOnce waits for.
        private sealed class Answer : TaskCompletionSource<object>
        {
            public readonly Type Asked;
            public Answer(Type asked) : base(TaskCreationOptions.RunContinuationsAsynchronously) { Asked = asked; }
        }
        private sealed class DwellQueue : Queue<Dwell> { public int Rows; }

        private readonly ConcurrentDictionary<string, Answer> waiting_ = new ConcurrentDictionary<string, Answer>();
        private readonly Dictionary<uint, Frame> begun_ = new Dictionary<uint, Frame>();        // by stream_id
        private readonly Dictionary<string, Frame> passes_ = new Dictionary<string, Frame>();  // by radar: the newest pass
        private readonly Dictionary<string, DwellQueue> dwells_ = new Dictionary<string, DwellQueue>();  // by radar; locked
        private long requests_;
        private Frame newest_;
        private volatile ObliqException end_;

        private ObliqStream() { }

        public Welcome Welcome { get; private set; }
        /// <summary>Why the connection has ended; null while it lasts.</summary>
        public ObliqException End { get { return end_; } }
        /// <summary>News that answers no request, on a thread of the pool: control was taken over, a radar cannot be rendered.</summary>
        public event Action<ObliqException> Noticed;

        /// <param name="url">ws://HOST:7480/stream, or wss:// where the server has a certificate.</param>
        /// <param name="token">Where the server wants one; travels inside the stream.</param>
        public static async Task<ObliqStream> ConnectAsync(string url, string token = null, string name = "csharp")
        {
            var stream = new ObliqStream();
            stream.socket_.Options.AddSubProtocol("obliq.v1.json");
            await stream.socket_.ConnectAsync(new Uri(url), stream.closing_.Token).ConfigureAwait(false);
            _ = Task.Run(() => stream.ReadAsync());
            var hello = new Fields().Add("major", 1L).Add("minor", 2L).Add("client_name", name).Add("token", token);
            stream.Welcome = Json<Welcome>((string)await stream.AskAsync(Type.Hello, hello).ConfigureAwait(false));
            return stream;
        }

        // ---- Requests ----

        public async Task<RadarInfo> GetRadarAsync(string radar)
        {
            return Json<RadarInfo>((string)await AskAsync(Type.GetRadar, new Fields().Add("radar", radar)).ConfigureAwait(false));
        }
        /// <summary>All settings of a radar, by the names of obliq.proto: gain, STC, beam, noise, rain and the rest. Numbers are
        /// texts with a point ("receiver_gain_db": "-6.5"), switches "true" or "false", choices their names.</summary>
        public async Task<Dictionary<string, string>> GetSettingsAsync(string radar)
        {
            return Scalars((string)await AskAsync(Type.GetRadar, new Fields().Add("radar", radar)).ConfigureAwait(false), "settings");
        }
        /// <param name="planes">"VIDEO", "IQ", "STATE"; labels, of a server of 1.2: "MATERIAL", "BUILDING", "HEIGHT", "RETURNS"; "TARGET", for its truth role.</param>
        public Task<Ack> SubscribeAsync(string radar, double rateHz, params string[] planes)
        {
            return AckAsync(Type.Subscribe, new Fields().Add("radar", radar).Add("rate_hz", rateHz).Add("planes", planes));
        }
        /// <summary>As SubscribeAsync, and Frame.Targets says where targets are. For the server's truth role (Welcome.truth).</summary>
        public Task<Ack> SubscribeWithTruthAsync(string radar, double rateHz, params string[] planes)
        {
            return AckAsync(Type.Subscribe, new Fields().Add("radar", radar).Add("rate_hz", rateHz).Add("planes", planes).Add("truth", true));
        }
        public Task<Ack> UnsubscribeAsync(string radar) { return AckAsync(Type.Unsubscribe, new Fields().Add("radar", radar)); }
        /// <summary>Pose and settings.</summary>
        public Task<Ack> ClaimAsync(string radar, bool force = false)
        {
            return AckAsync(Type.ClaimControl, new Fields().Add("radar", radar).Add("force", force));
        }
        /// <summary>The radar's knobs alone, while another client may fly it.</summary>
        public Task<Ack> ClaimSettingsAsync(string radar, bool force = false)
        {
            return AckAsync(Type.ClaimControl, new Fields().Add("radar", radar).Add("force", force).Add("kinds", new[] { "SETTINGS_CLAIM" }));
        }
        /// <summary>The radar's pose alone, while another client may turn its knobs.</summary>
        public Task<Ack> ClaimPoseAsync(string radar, bool force = false)
        {
            return AckAsync(Type.ClaimControl, new Fields().Add("radar", radar).Add("force", force).Add("kinds", new[] { "POSE_CLAIM" }));
        }
        /// <summary>All that this client holds.</summary>
        public Task<Ack> ReleaseAsync(string radar) { return AckAsync(Type.ReleaseControl, new Fields().Add("radar", radar)); }
        /// <param name="pose">Fields of Pose that change: new Fields().Add("bearing_deg", 0.0)</param>
        public Task<Ack> SetPoseAsync(string radar, Fields pose)
        {
            return AckAsync(Type.SetPose, new Fields().Add("radar", radar).Add("pose", pose));
        }
        /// <param name="settings">Fields of RadarSettings that change.</param>
        public Task<Ack> SetSettingsAsync(string radar, Fields settings)
        {
            return AckAsync(Type.SetSettings, new Fields().Add("radar", radar).Add("settings", settings));
        }
        /// <summary>Switches a radar as its operator does; null leaves a switch as it is.</summary>
        /// <param name="transmit">false: nothing is rendered.</param>
        /// <param name="freeze">true: frames keep the pose and the settings of this moment.</param>
        public Task<Ack> SetStateAsync(string radar, bool? transmit = null, bool? freeze = null)
        {
            var state = new Fields().Add("radar", radar);
            if (transmit != null) state.Add("transmit", transmit.Value);
            if (freeze != null) state.Add("freeze", freeze.Value);
            return AckAsync(Type.SetState, state);
        }
        /// <summary>Puts a radar, or all (""), back to the scene file's settings, pose and switches; for who holds both claims, or an admin.</summary>
        public Task<Ack> ResetExerciseAsync(string radar = "") { return AckAsync(Type.ResetExercise, new Fields().Add("radar", radar)); }
        /// <summary>Stops all radars for all stations, clock, antenna and noise, or lets them go on; for who holds all claims, or an admin.</summary>
        public Task<Ack> FreezeExerciseAsync(bool on) { return AckAsync(Type.SetExercise, new Fields().Add("frozen", on)); }
        /// <summary>Marks this moment of the exercise, or the place of a replay, for all stations; at most 1000 bytes of UTF-8, for a controller.</summary>
        public Task<Ack> BookmarkAsync(string text) { return AckAsync(Type.AddBookmark, new Fields().Add("text", text)); }
        /// <summary>The log of the exercise behind the event of that number, oldest first.</summary>
        public async Task<List<ExerciseEvent>> GetEventsAsync(long after = 0)
        {
            var all = new List<ExerciseEvent>();
            for (bool more = true; more;)
            {
                var page = Json<ExerciseEvents>((string)await AskAsync(Type.GetEvents, new Fields().Add("after", after)).ConfigureAwait(false));
                all.AddRange(page.events ?? new ExerciseEvent[0]);
                more = page.more;
                if (all.Count > 0) after = long.Parse(all[all.Count - 1].number, CultureInfo.InvariantCulture);
            }
            return all;
        }
        /// <summary>One frame for this client alone, of no live radar: its name is only echoed.</summary>
        /// <param name="pose">At least latitude_deg, longitude_deg and height_m.</param>
        /// <param name="settings">What is not in it has its default, not a live radar's value.</param>
        public async Task<Frame> RenderOnceAsync(string radar, Fields pose, Fields settings, params string[] planes)
        {
            return (Frame)await AskAsync(Type.RenderOnce, new Fields().Add("radar", radar).Add("pose", pose)
                .Add("settings", settings ?? new Fields()).Add("planes", planes)).ConfigureAwait(false);
        }
        /// <summary>As RenderOnceAsync, but what pose and settings do not have is as the live radar has it now.</summary>
        public async Task<Frame> RenderAsLiveAsync(string radar, Fields pose, Fields settings, params string[] planes)
        {
            return (Frame)await AskAsync(Type.RenderOnce, new Fields().Add("radar", radar).Add("as_live", true).Add("pose", pose ?? new Fields())
                .Add("settings", settings ?? new Fields()).Add("planes", planes)).ConfigureAwait(false);
        }
        /// <summary>As RenderAsLiveAsync, with the world's targets in it; where this client may be told (Welcome.truth), with Frame.Targets.</summary>
        public async Task<Frame> RenderWithTargetsAsync(string radar, Fields pose, Fields settings, params string[] planes)
        {
            return (Frame)await AskAsync(Type.RenderOnce, new Fields().Add("radar", radar).Add("as_live", true).Add("pose", pose ?? new Fields())
                .Add("settings", settings ?? new Fields()).Add("planes", planes).Add("live_targets", true).Add("truth", Welcome.truth))
                .ConfigureAwait(false);
        }

        // Targets belong to the world: all radars see them.

        /// <summary>This client alone may set them. They stay when it leaves.</summary>
        public Task<Ack> ClaimTargetsAsync(bool force = false)
        {
            return AckAsync(Type.ClaimControl, new Fields().Add("force", force).Add("kinds", new[] { "TARGETS_CLAIM" }));
        }
        public Task<Ack> ReleaseTargetsAsync() { return AckAsync(Type.ReleaseControl, new Fields().Add("kinds", new[] { "TARGETS_CLAIM" })); }
        /// <summary>All of them at once, or none. Ack.warnings: of what was left out.</summary>
        /// <param name="targets">Fields of Target, each with an id from 1: new Fields().Add("id", 7L).Add("type", "truck"). Of a known id what
        /// is not added keeps its value; of a new one it is its type's, or the default.</param>
        public Task<Ack> SetTargetsAsync(params Fields[] targets) { return ChangeTargetsAsync(targets, false); }
        /// <summary>As SetTargetsAsync; all others go at the same moment.</summary>
        public Task<Ack> ReplaceTargetsAsync(params Fields[] targets) { return ChangeTargetsAsync(targets, true); }
        public Task<Ack> ClearTargetsAsync() { return ChangeTargetsAsync(new Fields[0], true); }
        /// <summary>Takes some away; ids that the world has not are no fault.</summary>
        public Task<Ack> RemoveTargetsAsync(params ulong[] ids)
        {
            if (ids == null) throw new ArgumentNullException("ids");
            var gone = new List<string>();
            foreach (var id in ids) gone.Add(id.ToString(CultureInfo.InvariantCulture));
            return ChangeTargetsAsync("gone", gone, false);
        }
        /// <summary>All targets of the world, rising by id. For the server's truth role (Welcome.truth).</summary>
        public async Task<List<Target>> GetTargetsAsync()
        {
            var all = new List<Target>();
            for (bool more = true; more;)
            {
                var after = new Fields().Add("after", all.Count > 0 ? all[all.Count - 1].id : "0");
                var page = Json<TargetList>((string)await AskAsync(Type.GetTargets, after).ConfigureAwait(false));
                all.AddRange(page.targets ?? new Target[0]);
                if (all.Count > MostTargets) throw new IOException("a list of too many targets");
                more = page.more && page.targets != null && page.targets.Length > 0;
            }
            return all;
        }

        // Of the targets in one request, below the 65536 bytes and the 10000 values of a list that a server takes.
        private const int TargetPageBytes = 60000, TargetPageItems = 5000;

        private Task<Ack> ChangeTargetsAsync(Fields[] targets, bool clear)
        {
            if (targets == null || Array.IndexOf(targets, null) >= 0) throw new ArgumentNullException("targets");
            var texts = new List<string>();
            foreach (var target in targets) texts.Add(target.ToString());
            return ChangeTargetsAsync("targets", texts, clear);
        }

        // What one request does not hold goes in several: the server does all of it when the last has come.
        private async Task<Ack> ChangeTargetsAsync(string list, List<string> items, bool clear)
        {
            var pages = new List<List<string>> { new List<string>() };
            int bytes = 0;
            for (int k = 0; k < items.Count; ++k)
            {
                int more = Encoding.UTF8.GetByteCount(items[k]) + 1;
                if (more > TargetPageBytes)
                    throw new ObliqException(100, "not sent", new[] { new FieldFault {
                        field = list + "[" + k + "]", found = more + " bytes of JSON", allowed = "at most " + TargetPageBytes } });
                if (bytes + more > TargetPageBytes || pages[pages.Count - 1].Count == TargetPageItems)
                {
                    pages.Add(new List<string>());
                    bytes = 0;
                }
                pages[pages.Count - 1].Add(items[k]);
                bytes += more;
            }
            await settingTargets_.WaitAsync(closing_.Token).ConfigureAwait(false);
            try
            {
                Ack ack = null;
                for (int k = 0; k < pages.Count; ++k)
                {
                    bool isFirst = k == 0, isLast = k == pages.Count - 1;
                    var change = new Fields().AddJson(list, pages[k]).Add("clear", clear && isFirst).Add("more", !isLast);
                    ack = await AckAsync(Type.SetTargets, change).ConfigureAwait(false);
                }
                return ack;
            }
            finally { settingTargets_.Release(); }
        }
        /// <summary>The newest whole frame that has not been taken; of a turning radar a whole pass.</summary>
        public bool TryTakeFrame(out Frame frame) { return (frame = Interlocked.Exchange(ref newest_, null)) != null; }
        /// <summary>The oldest rows that have not been taken. What is older than two turns has been overwritten and is left out.</summary>
        public bool TryTakeDwell(out Dwell dwell)
        {
            lock (dwells_)
                foreach (var queue in dwells_.Values)
                    if (queue.Count > 0)
                    {
                        dwell = queue.Dequeue();
                        queue.Rows -= dwell.AzimuthCount;
                        return true;
                    }
            dwell = null;
            return false;
        }

        public void Dispose()
        {
            closing_.Cancel();
            socket_.Dispose();
        }

        private async Task<Ack> AckAsync(Type type, Fields fields)
        {
            return Json<Ack>((string)await AskAsync(type, fields).ConfigureAwait(false));
        }

        private async Task<object> AskAsync(Type type, Fields fields)
        {
            var id = Interlocked.Increment(ref requests_).ToString(CultureInfo.InvariantCulture);
            var answer = new Answer(type);
            waiting_[id] = answer;
            if (end_ != null) throw end_;
            await SendAsync(type, fields.Add("request_id", id)).ConfigureAwait(false);
            return await answer.Task.ConfigureAwait(false);
        }

        private async Task SendAsync(Type type, Fields fields)
        {
            var json = Encoding.UTF8.GetBytes(fields.ToString());
            var message = new byte[HeaderBytes + json.Length];
            var header = new BinaryWriter(new MemoryStream(message));  // little-endian, as the stream is
            header.Write(Magic);
            header.Write(new byte[] { 1, 1 });  // version
            header.Write((ushort)type);
            header.Write((ushort)1);            // flags: the descriptor is JSON
            header.Write((ushort)HeaderBytes);
            header.Write((uint)json.Length);    // payload
            header.Write((uint)json.Length);    // of that the descriptor
            json.CopyTo(message, HeaderBytes);
            await sending_.WaitAsync(closing_.Token).ConfigureAwait(false);
            try
            {
                await socket_.SendAsync(new ArraySegment<byte>(message), WebSocketMessageType.Binary, true, closing_.Token)
                    .ConfigureAwait(false);
            }
            finally { sending_.Release(); }
        }

        // ---- What arrives ----

        private async Task ReadAsync()
        {
            var buffer = new byte[1 << 16];
            try
            {
                while (true)
                {
                    int length = 0;
                    WebSocketReceiveResult got;
                    do
                    {
                        if (length == buffer.Length) Array.Resize(ref buffer, 2 * length);
                        got = await socket_.ReceiveAsync(new ArraySegment<byte>(buffer, length, buffer.Length - length),
                                                         closing_.Token).ConfigureAwait(false);
                        if (got.MessageType == WebSocketMessageType.Close) throw new IOException("the server has closed");
                        length += got.Count;
                    } while (!got.EndOfMessage);
                    await TakeAsync(buffer, length).ConfigureAwait(false);
                }
            }
            catch (Exception e)
            {
                if (end_ == null) end_ = new ObliqException(0, "the connection has ended: " + e.Message, null);
                foreach (var answer in waiting_.Values) answer.TrySetException(end_);
            }
        }

        private async Task TakeAsync(byte[] bytes, int length)
        {
            if (length < HeaderBytes || BitConverter.ToUInt32(bytes, 0) != Magic) throw new IOException("not an obliq stream");
            var type = (Type)BitConverter.ToUInt16(bytes, 6);
            int header = BitConverter.ToUInt16(bytes, 10), descriptor = BitConverter.ToInt32(bytes, 16);
            uint stream = BitConverter.ToUInt32(bytes, 20);
            int plane = header + descriptor;
            if (plane < header || plane > length) throw new IOException("a message with lengths that cannot be");
            var json = Encoding.UTF8.GetString(bytes, header, descriptor);
            Frame frame;
            switch (type)
            {
                case Type.FrameBegin:
                    begun_[stream] = Begin(Json<FrameBegin>(json), stream);
                    break;
                case Type.WedgeBlock:
                    if (begun_.TryGetValue(stream, out frame)) Put(frame, Json<WedgeBlock>(json), bytes, plane, length - plane);
                    break;
                case Type.TargetBlock:
                    if (begun_.TryGetValue(stream, out frame)) PutTargets(frame, Json<TargetBlock>(json), bytes, plane, length - plane);
                    break;
                case Type.FrameEnd:
                    if (begun_.TryGetValue(stream, out frame)) Complete(frame, Json<FrameEnd>(json));
                    begun_.Remove(stream);
                    break;
                case Type.FrameAbort:
                    if (begun_.TryGetValue(stream, out frame))
                    {
                        var aborted = new ObliqException(106, "aborted: " + Json<FrameAbort>(json).reason, null);
                        Finish(frame.Request, answer => answer.TrySetException(aborted));
                    }
                    begun_.Remove(stream);
                    break;
                case Type.Heartbeat:
                    var beat = Json<Heartbeat>(json);
                    if (beat.answer_wanted)
                        await SendAsync(Type.Heartbeat, new Fields().Add("request_id", beat.request_id)).ConfigureAwait(false);
                    break;
                case Type.Error:
                    Refuse(Json<ErrorMessage>(json));
                    break;
                default:
                    Answer asked;
                    var request = Json<Ack>(json).request_id;
                    if (request != null && waiting_.TryGetValue(request, out asked) && asked.Asked == Type.RenderOnce) break;
                    Finish(request, answer => answer.TrySetResult(json));
                    break;
            }
        }

        private void Refuse(ErrorMessage error)
        {
            var refusal = new ObliqException(error.number, error.text, error.fields);
            if (error.number < 100) end_ = refusal;  // such an error ends the connection
            bool answers = !string.IsNullOrEmpty(error.request_id) && error.request_id != "0";
            if (answers) Finish(error.request_id, answer => answer.TrySetException(refusal));
            else if (Noticed != null) Noticed(refusal);
        }

        private void Finish(string request, Action<Answer> how)
        {
            Answer answer;
            if (request != null && waiting_.TryRemove(request, out answer)) how(answer);
        }

        // ---- Frames ----

        // A radar has at most 8192 x 8192 bins.
        private const int MostAzimuths = 1 << 14, MostBins = 1 << 28;
        // Of a frame or a list: more than a hundred worlds have.
        private const int MostTargets = 1000000;
        // A pass that brought less than this part of its bytes and missed the others is given up, unless it is small; as
        // frame_assembler.cpp does.
        private const int LeastPart = 64, SmallBytes = 1 << 20;

        private Frame Begin(FrameBegin begin, uint stream)
        {
            // JsonUtility makes empty objects of absent ones.
            var scan = begin.scan == null || string.IsNullOrEmpty(begin.scan.mode) ? null : begin.scan;
            var frame = new Frame { Descriptor = begin.frame, Scan = scan, Request = begin.request_id, Stream = stream };
            long bins = (long)frame.AzimuthBins * frame.RangeBins;
            if (frame.AzimuthBins < 1 || frame.AzimuthBins > MostAzimuths || frame.RangeBins < 1 || bins > MostBins)
                throw new IOException("a frame of " + frame.AzimuthBins + " x " + frame.RangeBins + " bins; allowed: 1 to " + MostAzimuths +
                                      " azimuths, at most " + MostBins + " bins");
            frame.Bearings_deg = new double[frame.AzimuthBins];
            for (int a = 0; a < frame.AzimuthBins; ++a) frame.Bearings_deg[a] = double.NaN;
            if (scan == null) frame.Seen(0, frame.AzimuthBins, frame.Descriptor.pose);
            if (scan == null) return frame;
            Frame before;
            if (passes_.TryGetValue(begin.frame.radar, out before)) frame.ContinueFrom(before);
            return passes_[begin.frame.radar] = frame;
        }

        private void Put(Frame frame, WedgeBlock block, byte[] bytes, int from, int count)
        {
            var name = string.IsNullOrEmpty(block.plane) ? "IQ" : block.plane;
            var to = frame.Plane(name);
            if (to == null) return;
            int binBytes = Frame.BytesOfABin(name), row = block.n_range * binBytes;
            if (count != block.n_azimuth * row) throw new IOException("a block that has not the bytes of its bins");
            for (int a = 0; a < block.n_azimuth; ++a)
                Buffer.BlockCopy(bytes, from + a * row, to,
                                 ((block.first_azimuth + a) * frame.RangeBins + block.first_range) * binBytes, row);
            frame.BytesReceived += count;
            if (frame.Scan == null) return;
            frame.Seen(block.first_azimuth, block.n_azimuth, block.pose);
            long beam_ns;
            long.TryParse(block.beam_ns, NumberStyles.Integer, CultureInfo.InvariantCulture, out beam_ns);
            Tell(frame, name, block.first_azimuth, block.n_azimuth, block.pose, beam_ns);
        }

        private static void PutTargets(Frame frame, TargetBlock block, byte[] bytes, int from, int count)
        {
            var before = frame.Targets ?? new TargetTruth[0];
            if (block.records < 0 || block.record_bytes < TargetTruth.RecordBytes || count != (long)block.records * block.record_bytes)
                throw new IOException("targets that have not the bytes of their records");
            if (before.Length + block.records > MostTargets) throw new IOException("a frame of too many targets");
            var all = new TargetTruth[before.Length + block.records];
            before.CopyTo(all, 0);
            for (int k = 0; k < block.records; ++k) all[before.Length + k] = TargetTruth.Read(bytes, from + k * block.record_bytes);
            frame.Targets = all;
        }

        private void Complete(Frame frame, FrameEnd end)
        {
            if (!string.IsNullOrEmpty(frame.Request) && frame.Request != "0")
            {
                Finish(frame.Request, answer => answer.TrySetResult(frame));
                return;
            }
            var missed = end.missed ?? new AzimuthSpan[0];
            long rows = 0, bytes = frame.Bytes();
            foreach (var span in missed) rows += span.n_azimuth;
            if (rows > frame.AzimuthBins) throw new IOException("more azimuth bins were missed than the frame has");
            if (bytes > SmallBytes && LeastPart * frame.BytesReceived < bytes) return;
            foreach (var name in frame.Planes())
            {
                if (frame.Scan == null) Tell(frame, name, 0, frame.AzimuthBins, frame.Descriptor.pose, 0);
                foreach (var span in missed)  // what was not looked at holds no echo
                {
                    frame.Seen(span.first_azimuth, span.n_azimuth, frame.Descriptor.pose);
                    if (frame.Continues) frame.SetEmpty(name, span.first_azimuth, span.n_azimuth);
                    Tell(frame, name, span.first_azimuth, span.n_azimuth, frame.Descriptor.pose, 0);
                }
            }
            Interlocked.Exchange(ref newest_, frame);
        }

        private void Tell(Frame frame, string plane, int first, int count, Pose pose, long beam_ns)
        {
            var dwell = new Dwell { Picture = frame, Plane = plane, FirstAzimuth = first, AzimuthCount = count, Pose = pose, BeamNs = beam_ns };
            lock (dwells_)
            {
                DwellQueue queue;
                if (!dwells_.TryGetValue(frame.Descriptor.radar, out queue)) queue = dwells_[frame.Descriptor.radar] = new DwellQueue();
                queue.Enqueue(dwell);
                queue.Rows += count;
                // A beam that goes to and fro passes every azimuth in two turns.
                int most = 2 * frame.AzimuthBins * frame.Planes().Count;
                while (queue.Rows > most && queue.Count > 1) queue.Rows -= queue.Dequeue().AzimuthCount;
            }
        }

        // The members of an object without objects in it, as the server writes it: numbers, names, true and false.
        private static Dictionary<string, string> Scalars(string json, string name)
        {
            var found = new Dictionary<string, string>();
            int at = json.IndexOf("\"" + name + "\"", StringComparison.Ordinal);
            at = at < 0 ? -1 : json.IndexOf('{', at);
            int end = at < 0 ? -1 : json.IndexOf('}', at);
            if (end < 0) return found;
            foreach (var member in json.Substring(at + 1, end - at - 1).Split(','))
            {
                int colon = member.IndexOf(':');
                if (colon > 0) found[member.Substring(0, colon).Trim().Trim('"')] = member.Substring(colon + 1).Trim().Trim('"');
            }
            return found;
        }

        private static T Json<T>(string text)
        {
#if UNITY_5_3_OR_NEWER
            return JsonUtility.FromJson<T>(text);
#else
            using (var bytes = new MemoryStream(Encoding.UTF8.GetBytes(text)))
                return (T)new DataContractJsonSerializer(typeof(T)).ReadObject(bytes);
#endif
        }
    }
}
