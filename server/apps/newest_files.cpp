#include "server/apps/newest_files.h"

#include <cstdio>
#include <utility>

#include "proto/obliq.pb.h"
#include "server/apps/received_bins.h"
#include "server/output/frame_files.h"

namespace obliq {

NewestFiles::NewestFiles(std::string folder) : folder_(std::move(folder)) { prepare_output_folder(folder_); }

void NewestFiles::write(client::AssembledFrame frame) {
  const BinBlock bins = take_bins(frame);
  const std::string missing = write_frame_files(folder_, *frame.descriptor, *frame.summary, bins);
  if (missing != missing_ && !missing.empty())
    std::fprintf(stderr, "warning: %s: %s\n", folder_.c_str(), missing.c_str());
  missing_ = missing;
}

}  // namespace obliq
