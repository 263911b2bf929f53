// A client of obliqd in one file, without packages: for .NET, Mono and Unity (2021 or later). The stream over a
// WebSocket, subprotocol obliq.v1.json, as proto/PROTOCOL.md, "WebSocket", has it.
//
//   var radar = await ObliqStream.ConnectAsync("ws://127.0.0.1:7480/stream");
//   await radar.SubscribeAsync("main", 30, "VIDEO");
//   ... in every turn of the loop:  if (radar.TryTakeFrame(out var frame)) texture.LoadRawTextureData(frame.Video);
//
// Requests may come from any thread; each task ends when the server has answered, with an ObliqException when it
// refused. Frames wait for whoever takes them, the newest only.
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
    }

    [Serializable, DataContract]
    public sealed class Pose
    {
        [DataMember] public double latitude_deg, longitude_deg, height_m, bearing_deg, tilt_deg;
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
        [DataMember] public string request_id, radar, controller, fault, settings_version;
        [DataMember] public RadarSettings settings;
        [DataMember] public Pose pose;
        [DataMember] public bool controlled_by_you, transmit_off, frozen, pose_stale;
    }

    [Serializable, DataContract]
    public sealed class Ack { [DataMember] public string request_id, settings_version; [DataMember] public string[] warnings; }

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

    [Serializable, DataContract]
    internal sealed class FrameBegin { [DataMember] public FrameDescriptor frame; }

    [Serializable, DataContract]
    internal sealed class WedgeBlock
    {
        [DataMember] public string plane;  // absent: IQ, as every enum's first
        [DataMember] public int first_azimuth, n_azimuth, first_range, n_range;
    }

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

    /// <summary>A whole frame. Azimuth is the slow index, range the fast one: bin (a, r) is at [a * RangeBins + r].</summary>
    public sealed class Frame
    {
        public FrameDescriptor Descriptor;
        public int AzimuthBins { get { return Descriptor.settings.azimuth_bins; } }
        public int RangeBins { get { return Descriptor.settings.range_bins; } }
        public byte[] Video;  ///< 0: nothing; else 1 + 254 (dB - video_floor_db) / video_span_db; null when not asked for
        public byte[] State;  ///< 0 not sampled, 1 sampled, 2 shadow, 3 no surface, 4 no ground at this range
        public float[] Iq;    ///< real and imaginary parts in turn
    }

    /// <summary>The JSON of a request. Only what is added is sent: with proto3's optional fields 0 is a value.</summary>
    public sealed class Fields
    {
        private readonly StringBuilder text_ = new StringBuilder("{");
        public Fields Add(string name, string value) { return value == null ? this : Put(name, Quoted(value)); }
        public Fields Add(string name, bool value) { return Put(name, value ? "true" : "false"); }
        public Fields Add(string name, long value) { return Put(name, value.ToString(CultureInfo.InvariantCulture)); }
        public Fields Add(string name, double value)
        {
            bool odd = double.IsNaN(value) || double.IsInfinity(value);
            var text = value.ToString("R", CultureInfo.InvariantCulture);
            return Put(name, odd ? Quoted(text.Replace("\u221E", "Infinity")) : text);
        }
        public Fields Add(string name, Fields value) { return Put(name, value.ToString()); }
        public Fields Add(string name, IEnumerable<string> values)
        {
            var quoted = new List<string>();
            foreach (var value in values) quoted.Add(Quoted(value));
            return Put(name, "[" + string.Join(",", quoted.ToArray()) + "]");
        }
        public override string ToString() { return text_ + "}"; }

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
            ReleaseControl = 21, SetSettings = 22, SetPose = 23, Subscribe = 24, Unsubscribe = 25, SetState = 29,
            FrameBegin = 48, WedgeBlock = 49, FrameEnd = 50, FrameAbort = 51
        }

        private readonly ClientWebSocket socket_ = new ClientWebSocket();
        private readonly CancellationTokenSource closing_ = new CancellationTokenSource();
        private readonly SemaphoreSlim sending_ = new SemaphoreSlim(1, 1);
        private readonly ConcurrentDictionary<string, TaskCompletionSource<string>> waiting_ =
            new ConcurrentDictionary<string, TaskCompletionSource<string>>();
        private readonly Dictionary<uint, Frame> begun_ = new Dictionary<uint, Frame>();  // by stream_id
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
            var hello = new Fields().Add("major", 1L).Add("minor", 1L).Add("client_name", name).Add("token", token);
            stream.Welcome = Json<Welcome>(await stream.AskAsync(Type.Hello, hello).ConfigureAwait(false));
            return stream;
        }

        // ---- Requests ----

        public async Task<RadarInfo> GetRadarAsync(string radar)
        {
            return Json<RadarInfo>(await AskAsync(Type.GetRadar, new Fields().Add("radar", radar)).ConfigureAwait(false));
        }
        /// <param name="planes">"VIDEO", "IQ", "STATE".</param>
        public Task<Ack> SubscribeAsync(string radar, double rateHz, params string[] planes)
        {
            return AckAsync(Type.Subscribe, new Fields().Add("radar", radar).Add("rate_hz", rateHz).Add("planes", planes));
        }
        public Task<Ack> UnsubscribeAsync(string radar) { return AckAsync(Type.Unsubscribe, new Fields().Add("radar", radar)); }
        public Task<Ack> ClaimAsync(string radar, bool force = false)
        {
            return AckAsync(Type.ClaimControl, new Fields().Add("radar", radar).Add("force", force));
        }
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
        /// <summary>The newest whole frame that has not been taken.</summary>
        public bool TryTakeFrame(out Frame frame) { return (frame = Interlocked.Exchange(ref newest_, null)) != null; }

        public void Dispose()
        {
            closing_.Cancel();
            socket_.Dispose();
        }

        private async Task<Ack> AckAsync(Type type, Fields fields)
        {
            return Json<Ack>(await AskAsync(type, fields).ConfigureAwait(false));
        }

        private async Task<string> AskAsync(Type type, Fields fields)
        {
            var id = Interlocked.Increment(ref requests_).ToString(CultureInfo.InvariantCulture);
            var answer = new TaskCompletionSource<string>(TaskCreationOptions.RunContinuationsAsynchronously);
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
                    begun_[stream] = new Frame { Descriptor = Json<FrameBegin>(json).frame };
                    break;
                case Type.WedgeBlock:
                    if (begun_.TryGetValue(stream, out frame)) Put(frame, Json<WedgeBlock>(json), bytes, plane, length - plane);
                    break;
                case Type.FrameEnd:
                    if (begun_.TryGetValue(stream, out frame)) Interlocked.Exchange(ref newest_, frame);
                    begun_.Remove(stream);
                    break;
                case Type.FrameAbort:
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
                    Finish(Json<Ack>(json).request_id, answer => answer.TrySetResult(json));
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

        private void Finish(string request, Action<TaskCompletionSource<string>> how)
        {
            TaskCompletionSource<string> answer;
            if (request != null && waiting_.TryRemove(request, out answer)) how(answer);
        }

        private static void Put(Frame frame, WedgeBlock block, byte[] bytes, int from, int count)
        {
            int bins = frame.AzimuthBins * frame.RangeBins;
            if (block.plane == "VIDEO") Copy(frame.Video ?? (frame.Video = new byte[bins]), 1, frame, block, bytes, from, count);
            if (block.plane == "STATE") Copy(frame.State ?? (frame.State = new byte[bins]), 1, frame, block, bytes, from, count);
            if (string.IsNullOrEmpty(block.plane)) Copy(frame.Iq ?? (frame.Iq = new float[2 * bins]), 8, frame, block, bytes, from, count);
        }

        private static void Copy(Array to, int binBytes, Frame frame, WedgeBlock block, byte[] bytes, int from, int count)
        {
            int row = block.n_range * binBytes;
            if (count != block.n_azimuth * row) throw new IOException("a block that has not the bytes of its bins");
            for (int a = 0; a < block.n_azimuth; ++a)
                Buffer.BlockCopy(bytes, from + a * row, to,
                                 ((block.first_azimuth + a) * frame.RangeBins + block.first_range) * binBytes, row);
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
