#include "server/output/picture_caption.h"

#include <cairo.h>
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <ctime>

#include "proto/json_text.h"
#include "proto/obliq.pb.h"
#include "server/output/describe_frame.h"

namespace obliq {
namespace {

constexpr double kTitle = 15;
constexpr double kFont = 12;
constexpr double kLine = 18;
constexpr double kNorth = 62;   // width that the arrow takes
constexpr double kLegend = 72;  // height of the last row
constexpr double kBar = 230;
constexpr std::size_t kMostWarnings = 4;

/// Items in lines of at most `width`, a dot between them.
std::vector<std::string> flow(const std::vector<std::string>& items, double width) {
  std::vector<std::string> lines;
  for (const std::string& item : items) {
    if (item.empty()) continue;
    const std::string longer = lines.empty() ? item : lines.back() + " · " + item;
    if (lines.empty() || PictureCanvas::text_width(longer, kFont) > width) {
      lines.push_back(item);
    } else {
      lines.back() = longer;
    }
  }
  return lines;
}

/// A sentence in lines of at most `width`.
std::vector<std::string> wrap(const std::string& sentence, double width) {
  std::vector<std::string> lines(1);
  for (std::size_t at = 0; at < sentence.size();) {
    const std::size_t end = std::min(sentence.find(' ', at), sentence.size());
    const std::string word = sentence.substr(at, end - at);
    const std::string longer = lines.back().empty() ? word : lines.back() + " " + word;
    if (!lines.back().empty() && PictureCanvas::text_width(longer, kFont) > width) {
      lines.push_back(word);
    } else {
      lines.back() = longer;
    }
    at = end + 1;
  }
  return lines;
}

std::string degrees_text(double value, char positive, char negative) {
  return fmt::format("{:.5f}° {}", std::abs(value), value < 0 ? negative : positive);
}

/// The pose's own time: a date where it can be one, else seconds of its controller's clock.
std::string time_text(std::int64_t sim_time_ns) {
  if (sim_time_ns == 0) return {};
  constexpr std::int64_t kYear2000_ns = 946684800000000000;
  if (sim_time_ns < kYear2000_ns) return fmt::format("t = {:.3f} s", static_cast<double>(sim_time_ns) * 1e-9);
  return utc_text(sim_time_ns);
}

std::string sampling_text(const wire::FrameDescriptor& d, const wire::FrameSummary& s) {
  const std::string kind = wire::enum_word(wire::FrustumKind_Name(d.settings().frustum()));
  const auto looks = static_cast<double>(s.rays());
  if (d.settings().frustum() == wire::SWEEP) return fmt::format("sweep of {:.0f} planes", looks);
  return fmt::format("{} frustum, {} x {} px, {:.1f} M rays", kind, d.settings().pixel_columns(),
                     d.settings().pixel_rows(), looks / 1e6);
}

}  // namespace

Colour grey_of(double level) {
  const double v = 0.07 + 0.93 * std::clamp(level, 0.0, 1.0);
  return {v * 0.96, v, v * 0.94};
}

std::string utc_text(std::int64_t utc_ns) {
  const std::time_t seconds = utc_ns / 1000000000;
  std::tm parts{};
  gmtime_r(&seconds, &parts);
  char text[48];
  const std::size_t n = std::strftime(text, sizeof text, "%Y-%m-%d %H:%M:%S", &parts);
  return std::string(text, n) + fmt::format(".{} UTC", utc_ns / 100000000 % 10);
}

PictureCaption::PictureCaption(const Facts& facts, double width) : facts_(facts), width_(width) {
  const wire::FrameDescriptor& d = facts.frame;
  const wire::FrameSummary& s = facts.summary;
  title_ = d.scene_name().empty() ? "radar " + d.radar() : d.scene_name() + " · radar " + d.radar();
  const std::string reference = wire::enum_word(wire::HeightReference_Name(d.pose().height_reference()));
  const double r_min_km = d.range_start_m() / 1000;
  const double r_max_km = r_min_km + d.range_spacing_m() * d.settings().range_bins() / 1000;
  lines_ = flow({"antenna " + degrees_text(d.pose().latitude_deg(), 'N', 'S') + ", " +
                     degrees_text(d.pose().longitude_deg(), 'E', 'W'),
                 fmt::format("{:.0f} m above the ", d.pose().height_m()) + reference,
                 fmt::format("bearing {:05.1f}°", compass_deg(d.pose().bearing_deg())),
                 facts.time.empty() ? time_text(d.pose().sim_time_ns()) : facts.time,
                 fmt::format("slant ranges {:.4g} to {:.4g} km", r_min_km, r_max_km),
                 fmt::format("{} x {} bins", d.settings().azimuth_bins(), d.settings().range_bins()),
                 fmt::format("{:.4g} GHz", d.settings().frequency_ghz()), sampling_text(d, s),
                 facts.up_rad == 0 ? "north is up" : "the bearing is up"},
                width - kNorth);
  // The frame's own first, and of what loading had to say as much as there is room for.
  std::vector<std::string> warnings = frame_warnings(d, s);
  std::ranges::reverse(warnings);
  for (std::size_t i = 0; i < warnings.size() && i < kMostWarnings; ++i)
    for (const std::string& line : wrap(warnings[i], width - kNorth)) warnings_.push_back(line);
  if (warnings.size() > kMostWarnings)
    warnings_.push_back(fmt::format("and {} more warnings", warnings.size() - kMostWarnings));
}

double PictureCaption::height() const {
  return kTitle + 6 + kLine * static_cast<double>(lines_.size() + warnings_.size()) + kLegend;
}

void PictureCaption::draw(PictureCanvas& canvas, double left, double top) const {
  double y = top + kTitle;
  canvas.ink(kInk);
  canvas.text(left, y, title_, kTitle, 0, true);
  y += 6;
  canvas.ink(kInk, 0.9);
  for (const std::string& line : lines_) canvas.text(left, y += kLine, line, kFont);
  canvas.ink(kWarning);
  for (const std::string& line : warnings_) canvas.text(left, y += kLine, line, kFont);
  draw_north(canvas, left + width_ - 22, top + 26);
  draw_legend(canvas, left, y + 12);
  draw_length(canvas, left + width_, y + 32);
}

void PictureCaption::draw_legend(PictureCanvas& canvas, double left, double top) const {
  double x = left;
  if (facts_.has_echoes) {
    canvas.ink(kFaint);
    canvas.text(x, top + 11, facts_.quantity, 11);
    for (int k = 0; k < static_cast<int>(kBar); ++k) {
      canvas.ink(grey_of(k / (kBar - 1)));
      canvas.fill_box(x + k, top + 17, 1.5, 14);
    }
    canvas.ink(kInk);
    canvas.text(x, top + 44, fmt::format("{:.4g} dB", facts_.range.low), 11);
    canvas.text(x + kBar / 2, top + 44, fmt::format("{:.4g}", (facts_.range.low + facts_.range.high) / 2), 11,
                0.5);
    canvas.text(x + kBar, top + 44, fmt::format("{:.4g} dB", facts_.range.high), 11, 1);
    x += kBar + 26;
  }
  const auto swatch = [&](const Colour& colour, const std::string& words) {
    canvas.ink(colour);
    canvas.fill_box(x, top + 17, 14, 14);
    cairo_rectangle(canvas.cairo(), x + 0.5, top + 17.5, 13, 13);
    canvas.ink(kFaint);
    cairo_set_line_width(canvas.cairo(), 1);
    cairo_stroke(canvas.cairo());
    canvas.ink(kInk, 0.9);
    canvas.text(x + 20, top + 28, words, kFont);
    x += 38 + PictureCanvas::text_width(words, kFont);
  };
  swatch(kShadow, facts_.dark);
  swatch(kNotSampled, "not sampled");
  swatch(kNoSurface, "no known ground");
}

void PictureCaption::draw_north(PictureCanvas& canvas, double x, double y) const {
  cairo_t* c = canvas.cairo();
  cairo_save(c);
  cairo_translate(c, x, y);
  cairo_rotate(c, -facts_.up_rad);
  cairo_move_to(c, 0, -16);
  cairo_line_to(c, 6.5, 12);
  cairo_line_to(c, 0, 7);
  cairo_line_to(c, -6.5, 12);
  cairo_close_path(c);
  canvas.ink(kInk);
  cairo_fill(c);
  cairo_restore(c);
  canvas.ink(kInk);
  canvas.text(x - 25 * std::sin(facts_.up_rad), y - 25 * std::cos(facts_.up_rad) + 4.5, "N", 13, 0.5, true);
}

void PictureCaption::draw_length(PictureCanvas& canvas, double right, double y) const {
  constexpr double kLongest = 170;
  const double length_m = round_step(kLongest * facts_.pixel_m);
  const double length = length_m / facts_.pixel_m;
  cairo_t* c = canvas.cairo();
  cairo_move_to(c, right - length, y - 5);
  cairo_line_to(c, right - length, y);
  cairo_line_to(c, right, y);
  cairo_line_to(c, right, y - 5);
  canvas.ink(kInk);
  cairo_set_line_width(c, 1.5);
  cairo_stroke(c);
  canvas.text(right - length / 2, y + 14, distance_text(length_m), 11, 0.5);
}

}  // namespace obliq
