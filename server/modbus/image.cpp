#include "server/modbus/image.h"

#include <algorithm>
#include <utility>

#include "server/log/log.h"
#include "server/modbus/encoding.h"
#include "terrain/base/units.h"

namespace obliq::modbus {
namespace {

/// The longest that a master waits for a change: below the second that masters usually give an answer.
constexpr std::chrono::milliseconds kPatience{900};

/// Which registers there are, in both tables.
const std::array<bool, kRegisters>& mapped() {
  static const auto all = [] {
    std::array<bool, kRegisters> map{};
    const auto mark = [&](int address, int count) {
      for (int i = 0; i < count; ++i) map[static_cast<std::size_t>(address + i)] = true;
    };
    for (const StatusRegister& r : status_registers()) mark(r.address, width(r.words));
    for (const Setpoint& s : setpoints()) mark(s.address, width(s.words));
    mark(kNameAddress, kNameRegisters);
    mark(kConsoleHeartbeat, 1);
    return map;
  }();
  return all;
}

bool has_registers(const Span& span) {
  if (span.address + span.count > kRegisters) return false;
  const auto first = mapped().begin() + span.address;
  return std::all_of(first, first + span.count, [](bool there) { return there; });
}

/// Panels read in blocks: gaps between registers are read as zeros.
bool may_read(const Span& span) {
  if (span.count == 0) return true;
  if (span.address + span.count > kRegisters) return false;
  const auto first = mapped().begin() + span.address;
  return std::any_of(first, first + span.count, [](bool there) { return there; });
}

bool addresses_exist(const Request& request) {
  const auto end = [](const Span& span) { return span.address + span.count; };
  switch (request.function) {
    case Function::read_coils:
      return end(request.read) <= kCoils;
    case Function::read_discrete_inputs:
      return end(request.read) <= static_cast<int>(discrete_inputs().size());
    case Function::write_coil:
    case Function::write_coils:
      return end(request.write) <= kCoils;
    default:
      return may_read(request.read) && has_registers(request.write);
  }
}

bool writes_coils(const Request& request) {
  return request.function == Function::write_coil || request.function == Function::write_coils;
}

void put(const std::vector<std::uint16_t>& words, int address,
         std::array<std::uint16_t, kRegisters>& registers) {
  std::copy(words.begin(), words.end(), registers.begin() + address);
}

std::span<const std::uint16_t> words_of(const Setpoint& setpoint,
                                        const std::array<std::uint16_t, kRegisters>& registers) {
  return std::span(registers).subspan(static_cast<std::size_t>(setpoint.address),
                                      static_cast<std::size_t>(width(setpoint.words)));
}

/// The setpoint that an error of the radar's own checks is about. Checks of the terrain leave the section
/// out.
std::uint16_t address_of(const FieldError& error) {
  for (const Setpoint& s : setpoints())
    if (s.name == error.field || s.name.ends_with("." + error.field))
      return static_cast<std::uint16_t>(s.address);
  return kNoAddress;
}

}  // namespace

Image::Image(net::Panel& panel, double watchdog_s)
    : panel_(panel), watchdog_s_(watchdog_s), units_(panel.radars()) {
  for (std::size_t i = 0; i < units_.size(); ++i) {
    units_[i].staged.dirty.resize(setpoints().size());
    units_[i].facts.unit_id = static_cast<int>(i) + 1;
    units_[i].facts.radars = static_cast<int>(units_.size());
  }
}

Exception Image::perform(const Request& request, Registers& registers) {
  if (request.unit < 1 || request.unit > units_.size()) return Exception::no_such_unit;
  if (!addresses_exist(request)) return Exception::illegal_address;
  const std::size_t radar = request.unit - 1U;
  if (request.write.count > 0) {
    const Exception refusal =
        writes_coils(request) ? write_coils(radar, request) : write_registers(radar, request);
    if (refusal != Exception::none) return refusal;
  }
  fill(radar, registers);
  return Exception::none;
}

void Image::follow(std::size_t radar, Staged& staged) const {
  const auto status = panel_.status(radar);
  for (std::size_t i = 0; i < setpoints().size(); ++i)
    if (!staged.dirty[i]) put(encode(setpoints()[i], *status), setpoints()[i].address, staged.words);
}

int Image::count(const Staged& staged) {
  return static_cast<int>(std::count(staged.dirty.begin(), staged.dirty.end(), true));
}

Exception Image::write_registers(std::size_t radar, const Request& request) {
  const int first = request.write.address;
  const int end = first + request.write.count;
  for (int address = first; address < end; ++address)
    if (setpoint_at(address) == nullptr && address != kConsoleHeartbeat) return Exception::illegal_address;

  const std::lock_guard lock(mutex_);
  Unit& unit = units_[radar];
  Staged staged = unit.staged;
  follow(radar, staged);
  staged.words[kConsoleHeartbeat] = unit.beat;
  for (int i = 0; i < request.write.count; ++i) {
    std::uint16_t& word = staged.words[static_cast<std::size_t>(first + i)];
    word = request.function == Function::mask_write_register
               ? static_cast<std::uint16_t>((word & request.and_mask) | (request.or_mask & ~request.and_mask))
               : request.values[static_cast<std::size_t>(i)];
  }
  for (std::size_t i = 0; i < setpoints().size(); ++i) {
    const Setpoint& setpoint = setpoints()[i];
    const int past = setpoint.address + width(setpoint.words);
    if (past <= first || setpoint.address >= end) continue;
    staged.dirty[i] = true;
    // Half of a value means nothing yet: apply looks at the whole.
    net::PanelChange unused;
    if (setpoint.address >= first && past <= end &&
        !decode(setpoint, words_of(setpoint, staged.words), unused)) {
      unit.facts.tell(Fault::out_of_range, setpoint.address);
      return Exception::illegal_value;
    }
  }
  if (first <= kConsoleHeartbeat && kConsoleHeartbeat < end) {
    const std::uint16_t beat = staged.words[kConsoleHeartbeat];
    if (!unit.armed || beat != unit.beat) unit.last_beat = Clock::now();
    unit.armed = true;
    unit.beat = beat;
  }
  unit.staged = std::move(staged);
  unit.facts.staged = count(unit.staged);
  return Exception::none;
}

Exception Image::write_coils(std::size_t radar, const Request& request) {
  std::array<std::optional<bool>, kCoils> asked;
  for (int i = 0; i < request.write.count; ++i)
    asked[static_cast<std::size_t>(request.write.address + i)] =
        request.values[static_cast<std::size_t>(i)] != 0;
  const auto pulled = [&](Coil coil) { return asked[coil].value_or(false); };

  net::PanelChange wanted;
  wanted.transmit = asked[kTransmit];
  wanted.freeze = asked[kFreeze];
  wanted.clear_faults = pulled(kClearFaults);
  wanted.reset = pulled(kReset);
  wanted.exercise_freeze = asked[kExerciseFreeze];
  const bool switches = wanted.transmit || wanted.freeze || wanted.exercise_freeze;
  if (pulled(kApply) || switches || wanted.clear_faults || wanted.reset) {
    const Exception refusal = change(radar, pulled(kApply), std::move(wanted));
    if (refusal != Exception::none) return refusal;
  }
  const std::lock_guard lock(mutex_);
  Unit& unit = units_[radar];
  if (pulled(kClearFaults)) {
    unit.facts.tell(Fault::none);
    unit.facts.watchdog_tripped = false;
  }
  if (pulled(kDiscard)) unit.staged.dirty.assign(setpoints().size(), false);
  unit.facts.staged = count(unit.staged);
  return Exception::none;
}

/// Decodes what is staged. False, with last_error set, when a value pieced together is out of limits.
bool Image::collect(std::size_t radar, Staged& staged, net::PanelChange& wanted) {
  Unit& unit = units_[radar];
  follow(radar, unit.staged);
  staged = unit.staged;
  for (std::size_t i = 0; i < setpoints().size(); ++i) {
    const Setpoint& setpoint = setpoints()[i];
    if (!staged.dirty[i] || decode(setpoint, words_of(setpoint, staged.words), wanted)) continue;
    unit.facts.tell(Fault::out_of_range, setpoint.address);
    return false;
  }
  return true;
}

Exception Image::change(std::size_t radar, bool apply, net::PanelChange wanted) {
  Staged sent;
  {
    const std::lock_guard lock(mutex_);
    if (apply) {
      if (units_[radar].applying) return Exception::busy;
      if (!collect(radar, sent, wanted)) return Exception::illegal_value;
      units_[radar].applying = true;
    }
  }
  // Without the mutex: a master that waits here delays no other.
  const net::PanelAnswer answer = panel_.change(radar, std::move(wanted), kPatience);

  const std::lock_guard lock(mutex_);
  Unit& unit = units_[radar];
  if (apply) unit.applying = false;
  if (answer.verdict == net::PanelVerdict::done) {
    // What was written meanwhile stays staged.
    for (std::size_t i = 0; apply && i < setpoints().size(); ++i)
      if (std::ranges::equal(words_of(setpoints()[i], sent.words),
                             words_of(setpoints()[i], unit.staged.words)))
        unit.staged.dirty[i] = false;
    return Exception::none;
  }
  unit.facts.last_error_address = answer.errors.empty() ? kNoAddress : address_of(answer.errors.front());
  if (answer.verdict == net::PanelVerdict::invalid) {
    unit.facts.last_error = answer.over ? fault_of_limit(answer.over->limit) : Fault::refused;
    log_warning("modbus unit {}: apply refused: {}{}", unit.facts.unit_id,
                answer.over ? answer.over->text + "; " : "", all_text(answer.errors));
    return Exception::illegal_value;
  }
  unit.facts.last_error =
      answer.verdict == net::PanelVerdict::controlled ? Fault::controlled : Fault::no_answer;
  return Exception::busy;
}

void Image::fill(std::size_t radar, Registers& registers) {
  const auto status = panel_.status(radar);
  const std::lock_guard lock(mutex_);
  Unit& unit = units_[radar];
  const StatusView view{*status, unit.facts};
  for (const StatusRegister& r : status_registers())
    put(encode_number(r.value(view), r.words, r.counts_per_unit), r.address, registers.input);
  for (std::size_t i = 0; i < 2 * kNameRegisters; ++i) {
    const std::string& name = status->config.name;
    const unsigned character = i < name.size() ? static_cast<unsigned char>(name[i]) : 0U;
    std::uint16_t& word = registers.input[kNameAddress + i / 2];
    word = static_cast<std::uint16_t>(i % 2 == 0 ? character << 8 : word | character);
  }
  registers.input[kConsoleHeartbeat] = unit.beat;
  for (const Setpoint& s : setpoints()) put(encode(s, *status), s.address, registers.input);
  registers.holding = registers.input;
  for (std::size_t i = 0; i < setpoints().size(); ++i) {
    const auto words = words_of(setpoints()[i], unit.staged.words);
    if (unit.staged.dirty[i]) std::ranges::copy(words, registers.holding.begin() + setpoints()[i].address);
  }
  registers.coils = {};
  registers.coils[kTransmit] = status->transmit ? 1 : 0;
  registers.coils[kFreeze] = status->frozen ? 1 : 0;
  registers.coils[kExerciseFreeze] = status->exercise_frozen ? 1 : 0;
  registers.discrete = {};
  for (std::size_t i = 0; i < discrete_inputs().size(); ++i)
    registers.discrete[i] = discrete_inputs()[i].value(view) ? 1 : 0;
}

void Image::tick(Clock::time_point now) {
  if (watchdog_s_ <= 0) return;
  const std::lock_guard lock(mutex_);
  for (std::size_t i = 0; i < units_.size(); ++i) {
    Unit& unit = units_[i];
    if (!unit.armed || to_seconds(now - unit.last_beat) < watchdog_s_) continue;
    unit.armed = false;  // until it beats again
    unit.facts.watchdog_tripped = true;
    unit.facts.tell(Fault::watchdog);
    log_warning(
        "modbus unit {}: no heartbeat of the console for {} s: the radar is frozen. When the console is "
        "back: write coil {} (clear faults), then 0 to coil {} (freeze)",
        unit.facts.unit_id, watchdog_s_, static_cast<int>(kClearFaults), static_cast<int>(kFreeze));
    net::PanelChange freeze;
    freeze.freeze = true;
    panel_.command(i, std::move(freeze));  // posts; does not wait
  }
}

}  // namespace obliq::modbus
