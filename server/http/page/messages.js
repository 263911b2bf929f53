// Messages of the obliq stream as a WebSocket carries them: the 48-byte header, a descriptor in JSON with the field
// names of obliq.proto, plane values. PROTOCOL.md has the header; nothing here knows a socket.

export const SUBPROTOCOL = "obliq.v1.json";

const MAGIC = 0x514c424f; // "OBLQ", little-endian
const MAJOR = 1;
const MINOR = 2;
const HEADER_BYTES = 48;
const JSON_FLAG = 1;

/** As proto/message_type.h has them. @type {Partial<Record<keyof Messages, number>>} */
const NUMBERS = {
  Hello: 1, Welcome: 2, Ack: 3, Error: 4, Heartbeat: 5, ListRadars: 16, RadarList: 17, GetRadar: 18, RadarInfo: 19,
  ClaimControl: 20, ReleaseControl: 21, SetSettings: 22, SetPose: 23, Subscribe: 24, Unsubscribe: 25, RenderOnce: 26,
  GetStatus: 27, Status: 28, SetState: 29, QueryGround: 30, GroundAnswer: 31, SetReplay: 32, ReplayState: 33,
  SetTargets: 34, GetTargets: 35, TargetList: 36,
  ResetExercise: 37, GetExercise: 38, ExerciseState: 39, LoadExercise: 40, SetExercise: 41,
  GetEvents: 42, ExerciseEvents: 43, AddBookmark: 44,
  FrameBegin: 48, WedgeBlock: 49, FrameEnd: 50, FrameAbort: 51, TargetBlock: 52,
};
const NAMES = new Map(Object.entries(NUMBERS).map(([name, number]) => [number, name]));

/** @typedef {import("../wire.js").Messages} Messages those of obliq.proto */
/** @typedef {import("../wire.js").Real | import("../wire.js").Int64} Numeric a number of protobuf's JSON */

/**
 * A message of a type of obliq.proto; "" is one that this page does not know. utc_ms: when the server encoded it. Absent fields of the
 * body have their defaults.
 * @typedef {{[Type in keyof Messages]: {type: Type, stream: number, utc_ms: number, body: Messages[Type], plane: Uint8Array}}} MessageOf
 * @typedef {MessageOf[keyof Messages]} Message
 */

const writer = new TextEncoder();
const reader = new TextDecoder();

/**
 * @template {keyof Messages} Type
 * @param {Type} type
 * @param {Messages[Type]} body
 * @param {number} sequence
 * @returns {ArrayBuffer}
 */
export function encode(type, body, sequence) {
  const descriptor = writer.encode(JSON.stringify(body));
  const bytes = new Uint8Array(HEADER_BYTES + descriptor.length);
  const header = new DataView(bytes.buffer);
  header.setUint32(0, MAGIC, true);
  header.setUint8(4, MAJOR);
  header.setUint8(5, MINOR);
  header.setUint16(6, NUMBERS[type], true);
  header.setUint16(8, JSON_FLAG, true);
  header.setUint16(10, HEADER_BYTES, true);
  header.setUint32(12, descriptor.length, true);
  header.setUint32(16, descriptor.length, true);
  header.setBigUint64(24, BigInt(sequence), true);
  header.setBigInt64(32, BigInt(Math.round(utcNow_ms() * 1e3)) * 1000n, true);
  bytes.set(descriptor, HEADER_BYTES);
  return bytes.buffer;
}

/**
 * @param {ArrayBuffer} data one WebSocket message
 * @returns {Message}
 */
export function decode(data) {
  const header = new DataView(data);
  if (data.byteLength < HEADER_BYTES || header.getUint32(0, true) !== MAGIC || header.getUint8(4) !== MAJOR)
    throw new Error("the server speaks another protocol than this page");
  const start = header.getUint16(10, true);
  const length = header.getUint32(16, true);
  if (start < HEADER_BYTES || start + length > data.byteLength) throw new Error("a message's lengths are wrong");
  return /** @type {Message} */ ({
    type: NAMES.get(header.getUint16(6, true)) ?? "",
    stream: header.getUint32(20, true),
    utc_ms: Number(header.getBigInt64(32, true) / 1000n) / 1000,
    body: length ? JSON.parse(reader.decode(new Uint8Array(data, start, length))) : {},
    plane: new Uint8Array(data, start + length),
  });
}

/** UTC by this machine's clock, with fractions of a millisecond where the browser gives them. */
export function utcNow_ms() {
  return performance.timeOrigin + performance.now();
}

/**
 * A number of protobuf's JSON: 64 bits come as strings, infinity as a word.
 * @param {Numeric|undefined} value
 * @param {number} absent
 */
export function number(value, absent = 0) {
  return value === undefined ? absent : Number(value);
}
