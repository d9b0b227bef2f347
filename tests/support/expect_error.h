#pragma once

#include <gtest/gtest.h>

#include <initializer_list>
#include <string>

#include "runtime/error.h"

namespace vkopple::test {

/// Expects `action` to throw a one-line vkopple::Error whose text holds each of `parts`.
template <class Action>
void expect_error(Action&& action, std::initializer_list<std::string> parts) {
  try {
    action();
  } catch (const Error& error) {
    const std::string text = error.what();
    EXPECT_EQ(text.find('\n'), std::string::npos) << "more than one line: " << text;
    for (const std::string& part : parts)
      EXPECT_NE(text.find(part), std::string::npos) << "no '" << part << "' in: " << text;
    return;
  }
  std::string wanted;
  for (const std::string& part : parts) wanted += " '" + part + "'";
  ADD_FAILURE() << "nothing thrown, expected an error with" << wanted;
}

}  // namespace vkopple::test
