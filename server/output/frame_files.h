#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "server/output/ground_map_png.h"
#include "server/radar/bins.h"
#include "server/radar/pulse_train.h"

namespace obliq::wire {
class FrameDescriptor;
class FrameSummary;
}  // namespace obliq::wire

namespace obliq {

struct HeightGrid;
class SampleTextures;

/// Makes the folder and proves that it can be written, before any long work. Throws InputError.
void prepare_output_folder(const std::filesystem::path& directory);

struct FrameFileOptions {
  PictureOptions picture;                   ///< ground_map.tif is always north up
  const SampleTextures* samples = nullptr;  ///< for samples.exr
  std::vector<PulseTrain> trains{};         ///< for pulses.npy, [trains][pulses][range bins]
  /// World coordinates; ground_map.tif is placed by its heights. Without: as if all ground lay at one.
  const HeightGrid* ground = nullptr;
};

struct WrittenFrame {
  std::string missing;  ///< a sentence about the planes that the frame came without; empty: all are there
  std::optional<DbRange> scale;  ///< of the picture; none where there was nothing to see
};

/// Writes bins.npy, power.npy, count.npy, state.npy, and where they were asked for video.npy, those of labels
/// and pulses.npy, ground_map.png, ground_map.tif and, last, frame.json into `directory` (created if
/// missing): all of them or, where one cannot be written, none. A plane that `bins` does not have gives no
/// file, and an older frame's file of that name goes. The one writer behind `obliq render` and `obliq get`:
/// the same descriptor, summary and bins give the same files, bit for bit. Throws InputError that names the
/// file.
WrittenFrame write_frame_files(const std::filesystem::path& directory,
                               const wire::FrameDescriptor& descriptor, const wire::FrameSummary& summary,
                               const BinBlock& bins, const FrameFileOptions& options = {});

/// Writes a text file, whole or not at all. Throws InputError that names it.
void write_text(const std::filesystem::path& path, const std::string& text);

/// Writes timing.json, seconds by stage: outside the bit-for-bit promise. `profile`: a JSON object of its
/// own, or empty.
void write_timing(const std::filesystem::path& directory, const std::map<std::string, double>& seconds,
                  const std::string& profile = {});

/// Files of a folder that change together: each is written beside its place, under another name, and all are
/// renamed into place when all are whole. What fails leaves the folder as it was: a full disk never mixes the
/// files of two frames, and a reader never opens half a file.
class NewFiles {
 public:
  explicit NewFiles(std::filesystem::path directory) : directory_(std::move(directory)) {}
  /// Removes what was not put in place.
  ~NewFiles();
  NewFiles(const NewFiles&) = delete;
  NewFiles& operator=(const NewFiles&) = delete;

  using Writer = std::function<void(const std::filesystem::path&)>;
  /// `writer` writes the path that it is given; its InputError comes out naming the file itself.
  void add(const std::string& name, const Writer& writer);
  /// An older file of that name goes when the new ones come.
  void leave_out(const std::string& name);
  /// In the order in which they were added: the last one tells a reader that all are there. Throws
  /// InputError.
  void put_in_place();

 private:
  std::filesystem::path beside(const std::string& name) const;

  std::filesystem::path directory_;
  std::vector<std::string> written_;
  std::vector<std::string> left_out_;
};

/// One such file. A device or a pipe is written as it is.
void replace_file(const std::filesystem::path& path, const NewFiles::Writer& writer);

/// The descriptor of a frame's window as if it were a frame of its own, so that bin k lies where its number
/// says: edges, widths and bin counts are the window's. Of every n bins one, each stands for all n, from its
/// own near or left edge on. A frame without a window stays as it is. Throws InputError for a window that
/// has no bin in its frame.
wire::FrameDescriptor placed_window(const wire::FrameDescriptor& descriptor);

}  // namespace obliq
