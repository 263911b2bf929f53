#include "server/stream/frame_encoder.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <cstring>
#include <map>
#include <utility>

#include "proto/json_text.h"
#include "proto/limits.h"
#include "proto/obliq.pb.h"
#include "server/radar/render.h"

namespace obliq::stream {

static_assert(std::endian::native == std::endian::little, "plane data is sent as it lies in memory");

using wire::BinRun;
using wire::MessageType;
using wire::Plane;

namespace {

std::span<const std::byte> plane_values(Plane plane, int video_bits, const BinBlock& bins) {
  switch (plane) {
    case Plane::iq:
      return std::as_bytes(std::span(bins.iq));
    case Plane::power:
      return std::as_bytes(std::span(bins.power_w));
    case Plane::count:
      return std::as_bytes(std::span(bins.count));
    case Plane::state:
      return std::as_bytes(std::span(bins.state));
    case Plane::video:
      return video_bits == 8 ? std::as_bytes(std::span(bins.video8)) : std::as_bytes(std::span(bins.video16));
    case Plane::material:
      return std::as_bytes(std::span(bins.labels.material));
    case Plane::building:
      return std::as_bytes(std::span(bins.labels.building));
    case Plane::height:
      return std::as_bytes(std::span(bins.labels.height_m));
    case Plane::returns:
      return std::as_bytes(std::span(bins.labels.returns));
    case Plane::target:
      return std::as_bytes(std::span(bins.target));
    case Plane::pulses:  // of trains
      break;
  }
  return {};
}

// Cuts n_azimuth rows of n_range bins into rectangles that fit a block: whole rows where one fits, parts of a
// row, in order of range, where it does not.
std::vector<wire::Rectangle> cut(std::uint32_t bytes_per_bin, std::uint32_t n_azimuth,
                                 std::uint32_t n_range) {
  const std::uint32_t most_bins = wire::kMaxPlaneBytes / bytes_per_bin;
  const std::uint32_t ranges = std::min(n_range, most_bins);
  const std::uint32_t rows = ranges < n_range ? 1 : std::max(1u, most_bins / n_range);
  std::vector<wire::Rectangle> rectangles;
  for (std::uint32_t azimuth = 0; azimuth < n_azimuth; azimuth += rows) {
    for (std::uint32_t range = 0; range < n_range; range += ranges)
      rectangles.push_back(
          {azimuth, std::min(rows, n_azimuth - azimuth), range, std::min(ranges, n_range - range)});
  }
  return rectangles;
}

/// A run as rows of a wedge: the first kept row, and how many.
struct Rows {
  std::uint32_t first_bin = 0;
  std::uint32_t n = 0;
};
Rows rows_of(const BinRun& run, const BinBlock& bins) {
  const auto first = static_cast<std::uint64_t>(bins.first_azimuth);
  const std::uint32_t begin = run.index_from(first);
  const std::uint32_t end = run.index_from(first + static_cast<std::uint64_t>(bins.n_azimuth));
  return {run.first + begin * run.step, end - begin};
}

/// Whether a run keeps any of these azimuth bins.
bool meets(const BinRun& run, const AzimuthRange& azimuths) {
  const auto first = static_cast<std::uint64_t>(azimuths.first);
  return run.index_from(first) < run.index_from(first + static_cast<std::uint64_t>(azimuths.count));
}

int wedges_of(const BinRun& run) {
  const auto first = static_cast<int>(run.first) / kWedgeAzimuthBins;
  return (static_cast<int>(run.end()) + kWedgeAzimuthBins - 1) / kWedgeAzimuthBins - first;
}

}  // namespace

std::int64_t monotonic_ns() {
  using namespace std::chrono;
  return duration_cast<nanoseconds>(steady_clock::now().time_since_epoch()).count();
}

FrameEncoder::FrameEncoder(FrameIdentity identity, std::uint64_t& sequence)
    : identity_(std::move(identity)), sequence_(sequence), echo_(std::make_unique<wire::WedgeBlock>()) {
  if (identity_.choices.empty()) identity_.choices.emplace_back();
  as_json_ = std::ranges::any_of(identity_.choices, &StreamChoice::as_json);
  echo_->set_frame_id(identity_.frame_id);
  echo_->set_pose_received_ns(identity_.pose_received_ns);
  echo_->set_render_start_ns(monotonic_ns());
}
FrameEncoder::~FrameEncoder() = default;

std::shared_ptr<Block> FrameEncoder::new_block(MessageType type) {
  auto block = std::make_shared<Block>();
  block->type = type;
  block->stream_id = identity_.stream_id;
  block->frame_id = identity_.frame_id;
  block->sequence = ++sequence_;
  return block;
}

BlockPtr FrameEncoder::finish(std::shared_ptr<Block> block, bool as_json,
                              const google::protobuf::Message& message, std::span<const std::byte> values) {
  const wire::Addressing addressing{block->stream_id, block->sequence, wire::utc_now_ns()};
  // A block's head is a few hundred bytes.
  constexpr std::size_t kHeadBytes = 1024;
  wire::Bytes memory =
      identity_.meter ? identity_.meter->spare.take(values.size() + kHeadBytes) : wire::Bytes();
  block->bytes = wire::encode_message(block->type, addressing, message, values, wire::kMaxDescriptorBytes,
                                      std::move(memory));
  block->plane_bytes = values.size();
  if (as_json) block->json_head = wire::json_head(block->type, addressing, message, values.size());
  if (identity_.meter) {
    ++identity_.meter->blocks;
    identity_.meter->bytes += block->memory();
    block->meter = identity_.meter;
  }
  return block;
}

std::vector<BlockPtr> FrameEncoder::begin(const wire::FrameDescriptor& descriptor) {
  *echo_->mutable_pose() = descriptor.pose();
  echo_->set_pose_stale(descriptor.pose_stale());
  echo_->set_settings_version(descriptor.settings_version());
  iq_step_ = descriptor.adc_step();
  wire::FrameBegin message;
  message.set_frame_id(identity_.frame_id);
  message.set_request_id(identity_.request_id);
  message.set_frames_skipped(identity_.frames_skipped);
  *message.mutable_frame() = descriptor;
  if (scan_) *message.mutable_scan() = *scan_;

  wire::PlaneSet planes = 0;
  // And whether as JSON, too.
  std::map<std::pair<Plane, BlockFormat>, bool> wanted;
  std::map<wire::Window, bool> windows;
  for (const StreamChoice& choice : identity_.choices) {
    planes |= choice.planes;
    windows[choice.format.window] |= choice.as_json;
    for (int i = 0; i < wire::kPlanes; ++i) {
      const auto plane = static_cast<Plane>(i);
      if (choice.planes & wire::plane_bit(plane))
        wanted[{plane, choice.format.of_plane(plane)}] |= choice.as_json;
    }
  }
  const auto cut_to_frame = [&](const wire::Window& window) {
    return wire::cut_window(window, descriptor.settings().azimuth_bins(), descriptor.settings().range_bins());
  };
  products_.clear();
  for (const auto& [product, as_json] : wanted) {
    const auto& [plane, format] = product;
    if (const auto window = cut_to_frame(format.window))
      products_.push_back({plane, format, *window, as_json});
  }
  std::vector<BlockPtr> blocks;
  for (const auto& [window, as_json] : windows) {
    auto block = new_block(MessageType::frame_begin);
    block->planes = planes;
    block->format.window = window;
    const auto part = cut_to_frame(window);
    message.mutable_frame()->clear_window();
    if (part && !window.is_whole()) wire::write_window(*part, *message.mutable_frame()->mutable_window());
    message.set_wedges(part ? static_cast<std::uint32_t>(wedges_of(part->azimuth)) : 0);
    blocks.push_back(finish(std::move(block), as_json, message));
  }
  return blocks;
}

std::vector<BlockPtr> FrameEncoder::wedge(int wedge_index, const BinBlock& bins) {
  std::vector<BlockPtr> blocks;
  echo_->set_wedge_index(static_cast<std::uint32_t>(wedge_index));
  for (const Product& product : products_) {
    if (product.plane == Plane::pulses) continue;
    const Rows rows = rows_of(product.window.azimuth, bins);
    if (rows.n == 0) continue;
    const BinRun& azimuth = product.window.azimuth;
    echo_->set_azimuth_step(azimuth.step == 1 ? 0 : azimuth.step);
    const Source source{plane_values(product.plane, product.format.video_bits, bins),
                        rows.first_bin - static_cast<std::uint32_t>(bins.first_azimuth), azimuth.step, rows.n,
                        static_cast<std::size_t>(bins.n_range)};
    make(product, source, *echo_, blocks, [&](std::uint32_t first, std::uint32_t n) {
      echo_->set_first_azimuth(rows.first_bin + first * azimuth.step);
      echo_->set_n_azimuth(n);
    });
  }
  return blocks;
}

std::vector<BlockPtr> FrameEncoder::train(const PulseTrain& train) {
  std::vector<BlockPtr> blocks;
  wire::WedgeBlock message = *echo_;
  message.set_wedge_index(static_cast<std::uint32_t>(train.azimuths.first / kWedgeAzimuthBins));
  message.set_azimuth_step(0);
  message.set_first_azimuth(static_cast<std::uint32_t>(train.azimuths.first));
  message.set_n_azimuth(static_cast<std::uint32_t>(train.azimuths.count));
  message.mutable_pulse_period_ns()->Assign(train.period_ns.begin(), train.period_ns.end());
  message.set_boresight_start_deg(train.boresight_start_deg);
  message.set_boresight_rate_deg_s(train.boresight_rate_deg_s);
  const Source source{std::as_bytes(std::span(train.iq)), 0, 1, static_cast<std::uint32_t>(train.n_pulses),
                      static_cast<std::size_t>(train.n_range)};
  for (const Product& product : products_) {
    if (product.plane != Plane::pulses || !meets(product.window.azimuth, train.azimuths)) continue;
    make(product, source, message, blocks, [&](std::uint32_t first, std::uint32_t n) {
      message.set_first_pulse(first);
      message.set_n_pulses(n);
    });
  }
  return blocks;
}

void FrameEncoder::make(const Product& product, const Source& source, wire::WedgeBlock& message,
                        std::vector<BlockPtr>& blocks, const PlaceRows& place) {
  const BinRun& range = product.window.range;
  const std::uint32_t n_range = range.kept();

  // The kept bins as rows without gaps: where all of a row is kept they lie so already.
  const int video_bits = product.format.video_bits;
  const std::size_t bin_bytes =
      wire::coded_bytes_per_bin(product.plane, wire::IqEncoding::cf32_le, video_bits);
  const std::size_t source_row_bytes = source.row_values * bin_bytes;
  const std::size_t row_bytes = n_range * bin_bytes;
  std::span<const std::byte> values = source.values;
  if (row_bytes == source_row_bytes && source.step == 1) {
    values = values.subspan(source.first_row * row_bytes, source.n_rows * row_bytes);
  } else {
    picked_.resize(source.n_rows * row_bytes);
    std::byte* to = picked_.data();
    for (std::uint32_t row = 0; row < source.n_rows; ++row) {
      const std::byte* from =
          values.data() + (source.first_row + row * source.step) * source_row_bytes + range.first * bin_bytes;
      if (range.step == 1) {
        std::memcpy(to, from, row_bytes);
        to += row_bytes;
        continue;
      }
      for (std::uint32_t k = 0; k < n_range; ++k, to += bin_bytes)
        std::memcpy(to, from + k * range.step * bin_bytes, bin_bytes);
    }
    values = picked_;
  }

  const bool integers = wire::is_complex(product.plane) && product.format.iq == wire::IqEncoding::ci16_le;
  const std::uint32_t coded_bin_bytes =
      wire::coded_bytes_per_bin(product.plane, product.format.iq, video_bits);
  message.set_plane(static_cast<wire::PlaneKind>(product.plane));
  message.set_iq_encoding(integers ? wire::CI16_LE : wire::CF32_LE);
  message.set_range_step(range.step == 1 ? 0 : range.step);
  for (const wire::Rectangle& part : cut(coded_bin_bytes, source.n_rows, n_range)) {
    // Whole rows or a part of a single one: either way contiguous.
    const std::size_t n_bins = std::size_t{part.n_azimuth} * part.n_range;
    const std::size_t first = std::size_t{part.first_azimuth} * n_range + part.first_range;
    std::span<const std::byte> plain = values.subspan(first * bin_bytes, n_bins * bin_bytes);
    message.set_scale(0);
    if (integers) {
      coded_.resize(n_bins * coded_bin_bytes);
      const std::span iq(reinterpret_cast<const std::complex<float>*>(plain.data()), n_bins);
      message.set_scale(wire::encode_ci16(iq, coded_, iq_step_));
      plain = coded_;
    }
    const bool compresses = product.format.compression == wire::Compression::zstd;
    const std::vector<std::byte> compressed = compresses ? wire::compress(plain) : std::vector<std::byte>();
    message.set_compression(compressed.empty() ? wire::UNCOMPRESSED : wire::ZSTD);
    message.set_plain_bytes(compressed.empty() ? 0 : static_cast<std::uint32_t>(plain.size()));
    place(part.first_azimuth, part.n_azimuth);
    message.set_first_range(range.first + part.first_range * range.step);
    message.set_n_range(part.n_range);
    message.set_send_ns(monotonic_ns());
    auto block = new_block(MessageType::wedge_block);
    block->planes = wire::plane_bit(product.plane);
    block->format = product.format;
    blocks.push_back(
        finish(std::move(block), product.as_json, message, compressed.empty() ? plain : compressed));
  }
}

void FrameEncoder::set_scan(const wire::ScanPass& scan) { scan_ = std::make_unique<wire::ScanPass>(scan); }

void FrameEncoder::set_dwell(const wire::Pose& pose, std::int64_t pose_received_ns, bool pose_stale,
                             std::int64_t beam_ns) {
  *echo_->mutable_pose() = pose;
  echo_->set_pose_received_ns(pose_received_ns);
  echo_->set_pose_stale(pose_stale);
  echo_->set_beam_ns(beam_ns);
  echo_->set_render_start_ns(monotonic_ns());
}

BlockPtr FrameEncoder::targets(const AzimuthRange& azimuths, std::span<const wire::TargetRecord> records) {
  wire::TargetBlock message;
  message.set_frame_id(identity_.frame_id);
  message.set_records(static_cast<std::uint32_t>(records.size()));
  message.set_record_bytes(wire::kTargetRecordBytes);
  message.mutable_azimuths()->set_first_azimuth(static_cast<std::uint32_t>(azimuths.first));
  message.mutable_azimuths()->set_n_azimuth(static_cast<std::uint32_t>(azimuths.count));
  return finish(new_block(MessageType::target_block), as_json_, message,
                wire::encode_target_records(records));
}

BlockPtr FrameEncoder::end(const wire::FrameSummary& summary, double render_s,
                           const std::vector<AzimuthRange>& missed) {
  wire::FrameEnd message;
  message.set_frame_id(identity_.frame_id);
  *message.mutable_summary() = summary;
  message.set_render_s(render_s);
  message.set_waited_s(identity_.waited_s);
  for (const AzimuthRange& span : missed) {
    wire::AzimuthSpan& row = *message.add_missed();
    row.set_first_azimuth(static_cast<std::uint32_t>(span.first));
    row.set_n_azimuth(static_cast<std::uint32_t>(span.count));
  }
  return finish(new_block(MessageType::frame_end), as_json_, message);
}

BlockPtr FrameEncoder::abort(const std::string& reason) {
  wire::FrameAbort message;
  message.set_frame_id(identity_.frame_id);
  message.set_request_id(identity_.request_id);
  message.set_reason(reason);
  return finish(new_block(MessageType::frame_abort), as_json_, message);
}

}  // namespace obliq::stream
