#include "server/net/frame_encoder.h"

#include <algorithm>
#include <bit>
#include <chrono>

#include "proto/limits.h"
#include "proto/obliq.pb.h"

namespace obliq::net {

static_assert(std::endian::native == std::endian::little, "plane data is sent as it lies in memory");

using wire::MessageType;
using wire::Plane;

namespace {

std::span<const std::byte> plane_values(Plane plane, const BinBlock& bins) {
  switch (plane) {
    case Plane::iq:
      return std::as_bytes(std::span(bins.iq));
    case Plane::power:
      return std::as_bytes(std::span(bins.power_w));
    case Plane::count:
      return std::as_bytes(std::span(bins.count));
    case Plane::state:
      return std::as_bytes(std::span(bins.state));
  }
  return {};
}

// Cuts n_azimuth rows of n_range bins into rectangles that fit a block: whole rows where one fits, parts of a
// row, in order of range, where it does not.
std::vector<wire::Rectangle> cut(Plane plane, std::uint32_t n_azimuth, std::uint32_t n_range) {
  const std::uint32_t most_bins = wire::kMaxPlaneBytes / wire::bytes_per_bin(plane);
  const std::uint32_t ranges = std::min(n_range, most_bins);
  const std::uint32_t rows = ranges < n_range ? 1 : std::max(1u, most_bins / n_range);
  std::vector<wire::Rectangle> rectangles;
  for (std::uint32_t azimuth = 0; azimuth < n_azimuth; azimuth += rows) {
    for (std::uint32_t range = 0; range < n_range; range += ranges) {
      rectangles.push_back(
          {azimuth, std::min(rows, n_azimuth - azimuth), range, std::min(ranges, n_range - range)});
    }
  }
  return rectangles;
}

}  // namespace

std::int64_t monotonic_ns() {
  using namespace std::chrono;
  return duration_cast<nanoseconds>(steady_clock::now().time_since_epoch()).count();
}

FrameEncoder::FrameEncoder(const FrameIdentity& identity, std::uint64_t& sequence)
    : identity_(identity), sequence_(sequence), echo_(std::make_unique<wire::WedgeBlock>()) {
  echo_->set_frame_id(identity.frame_id);
  echo_->set_pose_received_ns(identity.pose_received_ns);
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

BlockPtr FrameEncoder::begin(const wire::FrameDescriptor& descriptor, int wedges) {
  *echo_->mutable_pose() = descriptor.pose();
  echo_->set_settings_version(descriptor.settings_version());
  wire::FrameBegin message;
  message.set_frame_id(identity_.frame_id);
  message.set_request_id(identity_.request_id);
  *message.mutable_frame() = descriptor;
  message.set_wedges(static_cast<std::uint32_t>(wedges));
  auto block = new_block(MessageType::frame_begin);
  block->planes = identity_.planes;
  block->bytes =
      wire::encode_message(block->type, {block->stream_id, block->sequence, wire::utc_now_ns()}, message);
  return block;
}

std::vector<BlockPtr> FrameEncoder::wedge(int wedge_index, const BinBlock& bins) {
  std::vector<BlockPtr> blocks;
  const auto n_range = static_cast<std::uint32_t>(bins.n_range);
  echo_->set_wedge_index(static_cast<std::uint32_t>(wedge_index));
  for (int i = 0; i < wire::kPlanes; ++i) {
    const auto plane = static_cast<Plane>(i);
    if (!(identity_.planes & wire::plane_bit(plane))) continue;
    echo_->set_plane(static_cast<wire::PlaneKind>(i));
    const auto values = plane_values(plane, bins);
    for (const wire::Rectangle& part : cut(plane, static_cast<std::uint32_t>(bins.n_azimuth), n_range)) {
      echo_->set_first_azimuth(static_cast<std::uint32_t>(bins.first_azimuth) + part.first_azimuth);
      echo_->set_n_azimuth(part.n_azimuth);
      echo_->set_first_range(part.first_range);
      echo_->set_n_range(part.n_range);
      echo_->set_send_ns(monotonic_ns());
      // Whole rows or a part of a single one: either way contiguous.
      const std::size_t first =
          (std::size_t{part.first_azimuth} * n_range + part.first_range) * wire::bytes_per_bin(plane);
      auto block = new_block(MessageType::wedge_block);
      block->planes = wire::plane_bit(plane);
      block->bytes =
          wire::encode_message(block->type, {block->stream_id, block->sequence, wire::utc_now_ns()}, *echo_,
                               values.subspan(first, wire::plane_bytes(plane, part)));
      blocks.push_back(std::move(block));
    }
  }
  return blocks;
}

BlockPtr FrameEncoder::end(const wire::FrameSummary& summary, double render_s) {
  wire::FrameEnd message;
  message.set_frame_id(identity_.frame_id);
  *message.mutable_summary() = summary;
  message.set_render_s(render_s);
  auto block = new_block(MessageType::frame_end);
  block->bytes =
      wire::encode_message(block->type, {block->stream_id, block->sequence, wire::utc_now_ns()}, message);
  return block;
}

BlockPtr FrameEncoder::abort(const std::string& reason) {
  wire::FrameAbort message;
  message.set_frame_id(identity_.frame_id);
  message.set_request_id(identity_.request_id);
  message.set_reason(reason);
  auto block = new_block(MessageType::frame_abort);
  block->bytes =
      wire::encode_message(block->type, {block->stream_id, block->sequence, wire::utc_now_ns()}, message);
  return block;
}

}  // namespace obliq::net
