// SPDX-License-Identifier: Apache-2.0
// What a person is told of work that has failed.
#pragma once
#include <chrono>
#include <exception>
#include <string>

namespace sg::serve {

std::string problem_of(const std::exception& e);
/// Of work that was ended after that time.
std::string took_too_long(std::chrono::milliseconds longest);
/// Of what was opened, called `what`.
std::string reading_took_too_long(const std::string& what, std::chrono::milliseconds longest);

}  // namespace sg::serve
