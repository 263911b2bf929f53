#include "server/asterix/radials.h"

#include <algorithm>
#include <utility>

#include "proto/obliq.pb.h"
#include "proto/plane_coding.h"

namespace obliq::asterix {

Radials::Radials(Listener listener)
    : FrameAssembler(wire::plane_bit(wire::Plane::video)), listener_(std::move(listener)) {}
Radials::~Radials() = default;

void Radials::forget() {
  rows_.clear();
  pass_.reset();
}

client::Status Radials::on_begin(const wire::MessageHeader& header, const wire::FrameBegin& begin) {
  client::Status status = FrameAssembler::on_begin(header, begin);
  if (!status.ok() || state() != State::receiving) return status;
  forget();
  if (begin.has_scan()) pass_ = Pass{begin.scan().clockwise(), begin.scan().rate_deg_s()};
  return listener_.on_begin(begin.frame());
}

// The base has checked that the blocks of a row come in order of range and fit the frame.
void Radials::keep(const wire::WedgeBlock& block, std::span<const std::byte> values) {
  const std::size_t octets = bits_ == 16 ? 2 : 1;
  for (std::size_t i = 0; i < block.n_azimuth(); ++i) {
    std::vector<std::uint16_t>& row = rows_[block.first_azimuth() + static_cast<std::uint32_t>(i)];
    const std::byte* cell = values.data() + i * block.n_range() * octets;
    std::size_t k = row.size();
    row.resize(k + block.n_range());
    for (; k < row.size(); ++k, cell += octets) {
      // Little-endian, as all of the wire outside protobuf.
      const unsigned high = bits_ == 16 ? std::to_integer<unsigned>(cell[1]) : 0;
      row[k] = static_cast<std::uint16_t>(std::to_integer<unsigned>(cell[0]) | high << 8);
    }
  }
}

// Those that are complete.
void Radials::hand_out_rows(std::optional<std::int64_t> beam_utc_ns) {
  RadialGroup group;
  group.frame = frame().descriptor.get();
  group.bits = bits_;
  const auto n_range = static_cast<std::size_t>(group.frame->settings().range_bins());
  for (auto row = rows_.begin(); row != rows_.end();) {
    if (row->second.size() < n_range) {
      ++row;
      continue;
    }
    group.rows.push_back({row->first, std::move(row->second)});
    row = rows_.erase(row);
  }
  if (group.rows.empty()) return;
  if (pass_) {
    if (!pass_->clockwise) std::ranges::reverse(group.rows);
    group.beam_utc_ns = beam_utc_ns;
    group.beam_s =
        group.frame->azimuth_width_deg() * static_cast<double>(group.rows.size()) / pass_->rate_deg_s;
  }
  listener_.on_radials(group);
}

client::Status Radials::on_block(const wire::MessageHeader& header, const wire::WedgeBlock& block,
                                 std::span<const std::byte> payload) {
  client::Status status = FrameAssembler::on_block(header, block, payload);
  const bool is_ours = state() == State::receiving && block.frame_id() == frame().descriptor->frame_id() &&
                       wire::plane_from_number(block.plane()) == wire::Plane::video;
  if (!status.ok() || !is_ours) return status;
  const auto values = wire::plain_values(block, payload, decoded_);
  if (!values) return status;  // its base has refused it
  if (!values->empty()) bits_ = wire::video_bits_of(block, payload.size());
  keep(block, *values);
  // PROTOCOL.md, "Latency".
  std::optional<std::int64_t> beam_utc_ns;
  if (block.beam_ns() != 0) beam_utc_ns = header.utc_ns - (block.send_ns() - block.beam_ns());
  if (pass_) hand_out_rows(beam_utc_ns);
  return status;
}

client::Status Radials::on_end(const wire::MessageHeader& header, const wire::FrameEnd& end) {
  client::Status status = FrameAssembler::on_end(header, end);
  if (!status.ok() || state() == State::receiving) return status;
  if (state() == State::complete) {
    hand_out_rows(std::nullopt);
    ++whole_frames_;
  }
  forget();
  (void)take();
  return status;
}

client::Status Radials::on_abort(const wire::MessageHeader& header, const wire::FrameAbort& abort) {
  client::Status status = FrameAssembler::on_abort(header, abort);
  if (state() != State::aborted) return status;
  forget();
  (void)take();
  return status;
}

void Radials::on_lost() {
  FrameAssembler::on_lost();
  forget();
}

}  // namespace obliq::asterix
