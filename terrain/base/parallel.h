#pragma once
#include <functional>
#include <string_view>

namespace obliq {

/// Calls work(row) once for every row in [0, n_rows), on all cores. Each call must write its own data only;
/// then the result does not depend on the number of threads. An exception from work is passed on.
void for_each_row(int n_rows, const std::function<void(int row)>& work);

/// Calls work(); what it gives to for_each_row is done on the calling thread alone.
void on_this_thread_alone(const std::function<void()>& work);

/// Told how far a long stage has come, 0 to 1. Called from one thread at a time; may be empty.
using Progress = std::function<void(std::string_view stage, double fraction)>;

}  // namespace obliq
