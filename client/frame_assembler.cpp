#include "client/frame_assembler.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <new>
#include <utility>

#include "proto/obliq.pb.h"
#include "proto/plane_coding.h"

namespace obliq::client {

static_assert(std::endian::native == std::endian::little, "plane data is copied as it comes");

namespace {

// Planes of this size are allocated at once.
constexpr std::uint64_t kSmall_bytes = 1 << 20;
// Larger ones when this part of their values has arrived: an eighth is copied twice, and memory is at most
// nine times what came.
constexpr std::uint64_t kPartThatArrives = 8;
// A pass that brought less than this part of its values and missed the others is given up.
constexpr std::uint64_t kLeastPartOfPass = 64;
constexpr std::size_t kMostTargets = 100 * std::size_t{wire::kMaxTargetRecords};
// Above any radar's limits. No product below can overflow, and what is kept for each azimuth bin from the
// frame's beginning is less than a megabyte.
constexpr int kMostAzimuths = 1 << 14;
constexpr int kMostRanges = 1 << 24;
constexpr int kMostPulses = 1 << 12;
constexpr std::uint8_t kNoMaterial = 255;

Status bad(std::string text) { return Status::failure(Outcome::bad_stream, std::move(text)); }

}  // namespace

AssembledFrame::AssembledFrame() = default;
AssembledFrame::~AssembledFrame() = default;
AssembledFrame::AssembledFrame(AssembledFrame&&) noexcept = default;
AssembledFrame& AssembledFrame::operator=(AssembledFrame&&) noexcept = default;

FrameAssembler::FrameAssembler(wire::PlaneSet planes, std::uint64_t max_bytes)
    : planes_(planes), max_bytes_(max_bytes) {}
FrameAssembler::~FrameAssembler() = default;

bool FrameAssembler::is_current(const wire::MessageHeader& header, std::uint64_t frame_id) const {
  return state_ == State::receiving && header.stream_id == stream_id_ && frame_id == frame_id_;
}

Status FrameAssembler::expect(std::uint64_t n_azimuth, std::uint64_t n_range) {
  bytes_expected_ = 0;
  bins_expected_ = 0;
  for (int i = 0; i < wire::kPlanes; ++i) {
    const auto plane = static_cast<wire::Plane>(i);
    if (!(planes_ & wire::kBinPlanes & wire::plane_bit(plane))) continue;
    bytes_expected_ += n_azimuth * n_range * wire::bytes_per_bin(plane);
    bins_expected_ += n_azimuth * n_range;
  }
  if (bytes_expected_ > max_bytes_)
    return bad("the frame needs " + std::to_string(bytes_expected_) + " bytes; allowed: at most " +
               std::to_string(max_bytes_));
  for (auto& filled : filled_) filled.assign(static_cast<std::size_t>(n_azimuth), 0);
  frame_.n_azimuth = static_cast<int>(n_azimuth);
  frame_.n_range = static_cast<int>(n_range);
  early_.clear();
  allocated_ = false;
  bins_received_ = 0;
  bytes_received_ = 0;
  return {};
}

bool FrameAssembler::has_arrived(std::uint64_t part) const {
  return bytes_expected_ <= kSmall_bytes || bytes_received_ >= bytes_expected_ / part;
}

Status FrameAssembler::no_memory() const {
  return bad("there is no memory for a frame of " + std::to_string(bytes_expected_) + " bytes");
}

// May throw bad_alloc.
void FrameAssembler::allocate() {
  const std::size_t bins =
      static_cast<std::size_t>(frame_.n_azimuth) * static_cast<std::size_t>(frame_.n_range);
  const auto wanted = [&](wire::Plane plane) { return planes_ & wire::plane_bit(plane) ? bins : 0; };
  frame_.iq.assign(wanted(wire::Plane::iq), {});
  frame_.power_w.assign(wanted(wire::Plane::power), 0.0);
  frame_.count.assign(wanted(wire::Plane::count), 0);
  frame_.state.assign(wanted(wire::Plane::state), 0);
  frame_.video.assign(wanted(wire::Plane::video), 0);
  frame_.material.assign(wanted(wire::Plane::material), kNoMaterial);
  frame_.building.assign(wanted(wire::Plane::building), 0);
  frame_.height_m.assign(wanted(wire::Plane::height), std::numeric_limits<float>::quiet_NaN());
  frame_.returns.assign(wanted(wire::Plane::returns), 0);
  frame_.target.assign(wanted(wire::Plane::target), 0);
  allocated_ = true;
  for (const Early& early : std::exchange(early_, {})) keep(early.plane, early.place, early.values);
}

// A block's values to their place, or aside. May throw bad_alloc.
void FrameAssembler::keep(wire::Plane plane, const wire::Rectangle& place,
                          std::span<const std::byte> values) {
  if (values.empty()) return;
  if (!allocated_) {
    early_.push_back({plane, place, {values.begin(), values.end()}});
    return;
  }
  const std::size_t bin_bytes = wire::bytes_per_bin(plane);
  const std::size_t row_bytes = place.n_range * bin_bytes;
  const auto n_range = static_cast<std::size_t>(frame_.n_range);
  for (std::size_t row = 0; row < place.n_azimuth; ++row) {
    const std::size_t bin = (place.first_azimuth + row) * n_range + place.first_range;
    std::memcpy(plane_data(plane) + bin * bin_bytes, values.data() + row * row_bytes, row_bytes);
  }
}

Status FrameAssembler::on_begin(const wire::MessageHeader& header, const wire::FrameBegin& begin) {
  if (state_ == State::receiving && header.stream_id != stream_id_) return {};
  if (state_ == State::receiving) return bad("a frame began before the one before it ended");
  const wire::RadarSettings& settings = begin.frame().settings();
  if (settings.azimuth_bins() < 1 || settings.azimuth_bins() > kMostAzimuths || settings.range_bins() < 1 ||
      settings.range_bins() > kMostRanges)
    return bad("a frame of " + std::to_string(settings.azimuth_bins()) + " x " +
               std::to_string(settings.range_bins()) + " bins; allowed: 1 to " +
               std::to_string(kMostAzimuths) + " x 1 to " + std::to_string(kMostRanges));
  const auto window = wire::cut_window(wire::read_window(begin.frame().window()), settings.azimuth_bins(),
                                       settings.range_bins());
  if (!window) return bad("a frame of a window without bins");
  window_ = *window;
  frame_ = {};
  if (Status status = expect(window_.azimuth.kept(), window_.range.kept()); !status.ok()) return status;
  frame_.frames_skipped = begin.frames_skipped();
  frame_.request_id = begin.request_id();
  frame_.descriptor = std::make_unique<wire::FrameDescriptor>(begin.frame());
  stream_id_ = header.stream_id;
  frame_id_ = begin.frame_id();
  abort_reason_.clear();
  state_ = State::receiving;
  return {};
}

std::byte* FrameAssembler::plane_data(wire::Plane plane) {
  void* const data[wire::kPlanes] = {frame_.iq.data(),       frame_.power_w.data(),  frame_.count.data(),
                                     frame_.state.data(),    frame_.video.data(),    nullptr,
                                     frame_.material.data(), frame_.building.data(), frame_.height_m.data(),
                                     frame_.returns.data(),  frame_.target.data()};
  return static_cast<std::byte*>(data[static_cast<int>(plane)]);
}

Status FrameAssembler::on_block(const wire::MessageHeader& header, const wire::WedgeBlock& block,
                                std::span<const std::byte> payload) {
  if (!is_current(header, block.frame_id())) return {};
  if (const std::string fault = wire::fault_of_block(block, payload.size()); !fault.empty())
    return bad(fault);
  const wire::Plane plane = *wire::plane_from_number(block.plane());
  if (!(planes_ & wire::plane_bit(plane))) return {};
  auto values = wire::plain_values(block, payload, scratch_);
  if (!values) return bad("a compressed data block is damaged");
  if (plane == wire::Plane::pulses) return add_pulses(block, *values);
  const auto place = place_of(block);
  if (!place) return bad("a data block does not fit the frame");
  if (plane == wire::Plane::video && !values->empty()) {
    frame_.video_bits = wire::video_bits_of(block, payload.size());
    if (frame_.video_bits == 8) {
      const auto* levels = reinterpret_cast<const std::uint8_t*>(values->data());
      video_.assign(levels, levels + values->size());
      values = std::as_bytes(std::span(video_));
    }
  }

  auto& filled = filled_[static_cast<int>(plane)];
  for (std::size_t row = 0; row < block.n_azimuth(); ++row) {
    std::uint32_t& so_far = filled[place->first_azimuth + row];
    if (so_far != place->first_range) return bad("a data block overlaps another or leaves a gap");
    so_far += block.n_range();
  }
  bins_received_ += std::uint64_t{block.n_azimuth()} * block.n_range();
  bytes_received_ += values->size();
  try {
    if (!allocated_ && has_arrived(kPartThatArrives)) allocate();
    keep(plane, *place, *values);
  } catch (const std::bad_alloc&) {
    return no_memory();
  }
  return {};
}

// Blocks of a train come in the order of its pulses, one train behind the other: memory follows what comes.
Status FrameAssembler::add_pulses(const wire::WedgeBlock& block, std::span<const std::byte> values) {
  const int n_pulses = frame_.descriptor->settings().doppler_pulses();
  const auto bins = static_cast<std::uint64_t>(frame_.descriptor->settings().azimuth_bins());
  const auto whole = static_cast<std::uint64_t>(std::max(0, n_pulses)) * window_.range.kept();
  std::vector<AssembledTrain>& trains = frame_.trains;
  if (trains.empty() || trains.back().iq.size() == whole) {
    if (n_pulses < 1 || n_pulses > kMostPulses || trains.size() >= bins || block.n_azimuth() < 1 ||
        std::uint64_t{block.first_azimuth()} + block.n_azimuth() > bins)
      return bad("a train of pulses does not fit the frame");
    AssembledTrain train;
    train.first_azimuth = static_cast<int>(block.first_azimuth());
    train.n_azimuth = static_cast<int>(block.n_azimuth());
    train.n_pulses = n_pulses;
    train.n_range = static_cast<int>(window_.range.kept());
    train.period_ns.assign(block.pulse_period_ns().begin(), block.pulse_period_ns().end());
    train.boresight_start_deg = block.boresight_start_deg();
    train.boresight_rate_deg_s = block.boresight_rate_deg_s();
    train.pose = std::make_shared<const wire::Pose>(block.pose());
    trains.push_back(std::move(train));
  }
  AssembledTrain& train = trains.back();
  const std::uint64_t n_range = window_.range.kept();
  const wire::BinRun& range = window_.range;
  const std::uint64_t first_range = std::uint64_t{range.first} + train.iq.size() % n_range * range.step;
  const bool fits = block.first_azimuth() == static_cast<std::uint32_t>(train.first_azimuth) &&
                    block.n_azimuth() == static_cast<std::uint32_t>(train.n_azimuth) &&
                    block.first_pulse() == train.iq.size() / n_range && block.first_range() == first_range &&
                    std::max(1u, block.range_step()) == range.step &&
                    train.iq.size() + wire::values_of(block) <= whole &&
                    (block.n_range() == n_range || block.n_pulses() == 1);
  if (!fits) return bad("a block of pulses overlaps another or leaves a gap");
  bytes_received_ += values.size();
  if (bytes_received_ > max_bytes_)
    return bad("the frame's pulses need more than " + std::to_string(max_bytes_) + " bytes");
  try {
    const std::size_t before = train.iq.size();
    train.iq.resize(before + values.size() / sizeof(train.iq[0]));
    if (!values.empty()) std::memcpy(train.iq.data() + before, values.data(), values.size());
  } catch (const std::bad_alloc&) {
    return no_memory();
  }
  return {};
}

// A block's rectangle, in bins of the window.
std::optional<wire::Rectangle> FrameAssembler::place_of(const wire::WedgeBlock& block) const {
  const auto place = [](const wire::BinRun& run, std::uint32_t first, std::uint32_t n,
                        std::uint32_t step) -> std::optional<std::uint32_t> {
    if (std::max(1u, step) != run.step || first < run.first || (first - run.first) % run.step != 0)
      return std::nullopt;
    const std::uint32_t index = (first - run.first) / run.step;
    if (index > run.kept() || n > run.kept() - index) return std::nullopt;
    return index;
  };
  const auto azimuth = place(window_.azimuth, block.first_azimuth(), block.n_azimuth(), block.azimuth_step());
  const auto range = place(window_.range, block.first_range(), block.n_range(), block.range_step());
  if (!azimuth || !range) return std::nullopt;
  return wire::Rectangle{*azimuth, block.n_azimuth(), *range, block.n_range()};
}

// Of all planes, in the dwells that the server says were missed; those must not have come. Nothing when they
// are more than the frame has, which would cost the square of their number.
std::optional<std::uint64_t> FrameAssembler::values_missed(const wire::FrameEnd& end) {
  std::uint64_t values = 0;
  std::uint64_t rows = 0;
  for (const wire::AzimuthSpan& span : end.missed()) {
    const auto row = [&](std::uint64_t azimuth) { return window_.azimuth.index_from(azimuth); };
    const std::uint32_t first = row(span.first_azimuth());
    const std::uint32_t past = row(std::uint64_t{span.first_azimuth()} + span.n_azimuth());
    rows += past - first;
    if (rows > static_cast<std::uint64_t>(frame_.n_azimuth)) return std::nullopt;
    for (std::uint32_t at = first; at < past; ++at) {
      for (int plane = 0; plane < wire::kPlanes; ++plane) {
        std::uint32_t& filled = filled_[plane][at];
        if (!(planes_ & wire::kBinPlanes & wire::plane_bit(static_cast<wire::Plane>(plane))) || filled != 0)
          continue;
        filled = static_cast<std::uint32_t>(frame_.n_range);
        values += filled;
      }
    }
    frame_.missed.emplace_back(static_cast<int>(span.first_azimuth()), static_cast<int>(span.n_azimuth()));
  }
  return values;
}

Status FrameAssembler::on_targets(const wire::MessageHeader& header, const wire::TargetBlock& block,
                                  std::span<const wire::TargetRecord> records) {
  if (!is_current(header, block.frame_id())) return {};
  // A dwell more than a frame has azimuth bins is none, nor are more targets than a world has in each.
  if (frame_.targets.size() + records.size() > kMostTargets) return bad("the frame has too many targets");
  frame_.targets.insert(frame_.targets.end(), records.begin(), records.end());
  return {};
}

Status FrameAssembler::on_end(const wire::MessageHeader& header, const wire::FrameEnd& end) {
  if (!is_current(header, end.frame_id())) return {};
  const auto missed = values_missed(end);
  if (!missed) return bad("the frame's end says that more azimuth bins were missed than the frame has");
  bins_expected_ -= *missed;
  if (bins_received_ != bins_expected_)
    return bad("the frame ended with " + std::to_string(bins_expected_ - bins_received_) + " values missing");
  if (!frame_.trains.empty()) {
    const AssembledTrain& last = frame_.trains.back();
    if (last.iq.size() != static_cast<std::size_t>(last.n_pulses) * static_cast<std::size_t>(last.n_range))
      return bad("the frame ended within a train of pulses");
  }
  if (!allocated_) {  // as where nearly all of a pass was missed
    if (!has_arrived(kLeastPartOfPass)) {
      abort_reason_ = "the scanning antenna missed nearly all of it";
      state_ = State::aborted;
      return {};
    }
    try {
      allocate();
    } catch (const std::bad_alloc&) {
      return no_memory();
    }
  }
  frame_.summary = std::make_unique<wire::FrameSummary>(end.summary());
  frame_.render_s = end.render_s();
  state_ = State::complete;
  return {};
}

Status FrameAssembler::on_abort(const wire::MessageHeader& header, const wire::FrameAbort& abort) {
  if (!is_current(header, abort.frame_id())) return {};
  abort_reason_ = abort.reason();
  state_ = State::aborted;
  return {};
}

void FrameAssembler::on_lost() {
  if (state_ == State::receiving) (void)take();
}

double FrameAssembler::fraction() const {
  return bins_expected_ == 0 ? 0 : static_cast<double>(bins_received_) / static_cast<double>(bins_expected_);
}

AssembledFrame FrameAssembler::take() {
  state_ = State::idle;
  early_.clear();
  return std::exchange(frame_, {});
}

}  // namespace obliq::client
