#pragma once

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

namespace fpbm::test {

/// Expects that f() throws std::invalid_argument with a message that contains `part`.
template <typename F>
void expect_refused(const F& f, const std::string& part) {
  try {
    f();
    ADD_FAILURE() << "accepted, without: " << part;
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
}

}  // namespace fpbm::test
