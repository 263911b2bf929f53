#pragma once
#include <filesystem>
#include <string>

namespace obliq::fuzz {

const std::filesystem::path& corpus_folder();
void write_seed(const std::string& target, const std::string& name, const std::string& bytes);

/// The files that GDAL reads.
void write_elevations();
void write_footprints();

}  // namespace obliq::fuzz
