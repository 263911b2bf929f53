#pragma once
// Whether two frames, or parts of them, have the same bits: stricter than ==, which takes -0 for 0.
#include <gtest/gtest.h>

#include <cstring>
#include <vector>

namespace obliq::test {

template <typename T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

/// Of I&Q, power, count and state: a BinBlock's, or a client's frame.
template <typename A, typename B>
void expect_same_bits(const A& a, const B& b) {
  EXPECT_TRUE(same_bits(a.iq, b.iq)) << "iq";
  EXPECT_TRUE(same_bits(a.power_w, b.power_w)) << "power";
  EXPECT_TRUE(same_bits(a.count, b.count)) << "count";
  EXPECT_TRUE(same_bits(a.state, b.state)) << "state";
}

}  // namespace obliq::test
