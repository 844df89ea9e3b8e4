// SPDX-License-Identifier: Apache-2.0
#include "render/trace/integrators/bidirectional/primary_space.h"

#include <cmath>
#include <numbers>

#include "base/random.h"
#include "render/trace/sampling/unit_float.h"

namespace sg::trace {

namespace {

constexpr double small_step = 0.01;  // standard deviation; n steps are one of sqrt(n) times that

uint64_t number_key(uint64_t key, uint32_t step, size_t part, size_t index) {
  return random_bits(random_bits(key, step), uint64_t(part) << 32 | uint64_t(index));
}

double normal_number(uint64_t key) {
  const double u = 1 - random_unit(key, 1), angle = 2 * std::numbers::pi * random_unit(key, 2);
  return std::sqrt(-2 * std::log(u)) * std::cos(angle);
}

}  // namespace

float PrimarySpace::fresh(uint32_t draw, size_t part, size_t index) const {
  return unit_float(uint32_t(number_key(draw == 0 ? first_ : chain_, draw, part, index) >> 32));
}

void PrimarySpace::propose(bool large) { ++draw_, asked_ = step_ + 1, large_ = large; }

void PrimarySpace::accept() {
  step_ = asked_;
  if (large_) large_step_ = step_, large_draw_ = draw_;
}

void PrimarySpace::reject() {
  for (auto& part : numbers_)
    for (Number& n : part)
      if (n.made && n.step == asked_) n.value = n.before, n.step = n.step_before;
  asked_ = step_;
}

void PrimarySpace::begin(Part part) { part_ = size_t(part), at_ = 0; }

float PrimarySpace::value(size_t part, size_t index) {
  auto& numbers = numbers_[part];
  if (index >= numbers.size()) numbers.resize(index + 1);
  Number& n = numbers[index];
  if (n.made && n.step == asked_) return n.value;
  // What nobody has asked for since the last large step is as that one would have made it.
  if (!n.made || n.step < large_step_) n.value = fresh(large_draw_, part, index), n.step = large_step_, n.made = true;
  n.before = n.value, n.step_before = n.step;
  if (n.step == asked_) return n.value;
  if (large_) {
    n.value = fresh(draw_, part, index);
  } else {
    const double steps = asked_ - n.step, by = normal_number(number_key(~chain_, draw_, part, index));
    const double moved = double(n.value) + small_step * std::sqrt(steps) * by;
    n.value = below_one(moved - std::floor(moved));
  }
  n.step = asked_;
  return n.value;
}

}  // namespace sg::trace
