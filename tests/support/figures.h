#pragma once
// Figures that a test measures, for the tables of ACCURACY.md: GoogleTest writes them into the file of
// --gtest_output=json:FILE, from which tests/figures/figures.py keeps them.
#include <gtest/gtest.h>

#include <cstdio>
#include <string>

namespace obliq::test {

/// A test's last value of a name counts; of one name in several tests the table shows the worst.
inline void record_figure(const std::string& name, double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", value);
  testing::Test::RecordProperty(name, text);
}

}  // namespace obliq::test
