#pragma once
// What a file that is written needs of the operating system: the calls that POSIX and Windows name
// differently. Errors are numbers of errno; 0: none.
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace obliq::client {

/// A descriptor of a new file, or of one that is written anew; -1: `error` says why.
int create_file(const std::string& path, bool overwrite, int& error);
/// Both behind what is there, all of it or up to the error.
int append_to_file(int file, std::span<const std::byte> first, std::span<const std::byte> second);
bool cut_file(int file, std::uint64_t bytes);
/// Waits until the disk has everything; a pipe or a device has nothing to wait for.
int flush_file(int file);
int close_file(int file);

}  // namespace obliq::client
