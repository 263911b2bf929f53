#pragma once
// frontier.csv: one line for each sampling and part of the returns. Everything that is drawn or summed up is
// read back from here, so that an interrupted run and a whole one give the same pictures.
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "server/accuracy/measure_frame.h"
#include "server/accuracy/sampling_case.h"
#include "server/accuracy/truth_search.h"

namespace obliq {

/// One line. Numbers are doubles throughout: the largest count, of rays, is far below 2^53.
struct FrontierRow {
  SamplingCase sampling;
  Returns returns = Returns::all;
  double frame_ms = 0;         ///< least of the repeats, all planes
  double frame_median_ms = 0;  ///< median of the same
  double bare_ms = 0;          ///< least, without the state plane
  double bare_median_ms = 0;
  double processor_ms = 0;  ///< least, all planes, all threads together
  double rays = 0;
  double samples = 0;
  double power_error = 0;  ///< E; this and the following as in BinErrors
  double median_db = 0;
  double percentile95_db = 0;
  double mean_relative = 0;
  double energy_error = 0;
  double bins = 0;
  double lit = 0;
  double dark = 0;
  double dont_care = 0;
  double gaps = 0;
  double gap_fraction = 0;
  double false_light = 0;
  double false_light_fraction = 0;  ///< of the dark bins
  double false_light_energy = 0;    ///< of the truth's energy
  double buildings_visible = 0;
  double buildings_missed = 0;
  double load = 0;           ///< the machine's, one minute, before the frames were timed
  std::string not_possible;  ///< why this sampling cannot see the scene; the numbers are then 0

  bool possible() const { return not_possible.empty(); }
  /// Whether the decibels are of any bin; else they are 0 and mean nothing.
  bool has_decibels() const { return lit > gaps; }
};

/// "all", "terrain", "buildings".
std::string returns_name(Returns returns);

/// The lines of one sampling: one, or three where there are buildings.
std::vector<FrontierRow> rows_of(const SamplingCase& sampling, const FrameMeasurement& measured, double load);
FrontierRow impossible_row(const SamplingCase& sampling, const std::string& reason);

std::string csv_header();
std::string csv_line(const FrontierRow& row);

/// Reads a table. A last line that was cut off is left out. Throws InputError that names file and line.
std::vector<FrontierRow> read_frontier_csv(const std::filesystem::path& path);

/// The row of a sampling and part of the returns, or null.
const FrontierRow* find_row(const std::vector<FrontierRow>& rows, const SamplingCase& sampling,
                            Returns returns);

/// What is compared with the paper's setting, over the same ground, in the same run, for one part of the
/// returns: first that setting itself, then for each kind the row of least E that takes no more time (the
/// quickest one where all take more). Empty when the paper's setting cannot see the scene.
std::vector<FrontierRow> compare_with_paper(const std::vector<FrontierRow>& rows, double scene_cell_m,
                                            Returns returns = Returns::all);

// frontier.json: which run a frontier.csv belongs to, and on what machine it was measured.

/// What frames are compared with: the reference renderer; or, where that would take hours, a frame of the
/// sweep with the reference quality's planes.
enum class Against { truth, reference };

struct FrontierHeader {
  /// Hash of scene, settings, options, machine and version: a run with another is another run.
  std::string key;
  std::string version;
  std::string scene;
  std::string radar;
  std::string view;  ///< one line: ranges, sector, bins
  std::string cpu;
  int threads = 0;
  std::string tracer;  ///< "Embree 3.13.5"
  int repeats = 0;
  int azimuth_bins = 0;
  int range_bins = 0;
  int azimuths_compared = 0;
  int buildings = 0;
  double scene_cell_m = 0;
  double truth_cell_m = 0;
  Against against = Against::truth;
  ReferenceSampling truth;  ///< Against::reference: planes alone
  std::vector<TruthCheck> truth_checks;
  int truth_check_azimuths = 0;
};

void write_frontier_header(const std::filesystem::path& path, const FrontierHeader& header);

/// Nothing when there is no such file. Throws InputError when it is no frontier's.
std::optional<FrontierHeader> read_frontier_header(const std::filesystem::path& path);

/// frontier.md: what was measured and how, the comparison with the paper's setting, one table for each part
/// of the returns, and what was not possible.
std::string frontier_markdown(const FrontierHeader& header, const std::vector<FrontierRow>& rows);

/// One line: machine, threads, tracer, repeats.
std::string machine_text(const FrontierHeader& header);

/// Writes frontier.svg and frontier.png into the folder: frame time against E, median dB, gaps and false
/// light of all returns, one colour for each kind, the paper's setting as a star. Throws InputError that
/// names the file.
void draw_frontier(const std::filesystem::path& folder, const FrontierHeader& header,
                   const std::vector<FrontierRow>& rows);

}  // namespace obliq
