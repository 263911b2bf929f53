#pragma once
// What tests do with clients.
#include <gtest/gtest.h>

#include <string>

#include "client/client.h"

namespace obliq::test {

constexpr client::Timeout kLong{60000};  ///< reached only when something is broken

/// For ASSERT_TRUE and EXPECT_TRUE: a failure says why.
inline testing::AssertionResult is_ok(const client::Status& status) {
  return (status.ok() ? testing::AssertionSuccess() : testing::AssertionFailure()) << status.sentence();
}

/// A client of the server at "HOST:PORT"; the test fails if it cannot be.
inline client::Client connected(const std::string& address, const std::string& name = "tester") {
  client::Client made;
  EXPECT_TRUE(is_ok(made.connect(*client::parse_endpoint(address), {.name = name})));
  return made;
}

}  // namespace obliq::test
