// SPDX-License-Identifier: Apache-2.0
#include "simulate/run/state_file.h"

#include <fmt/core.h>
#include <xxhash.h>

#include <algorithm>
#include <memory>
#include <string_view>

namespace sg {

namespace {

constexpr std::string_view magic = "Sightglass run 1\n";
constexpr size_t sum_bytes = 8;

[[noreturn]] void fail(const std::string& path, const std::string& what) {
  fail_data(what, "'" + path + "'", "remove it to begin again, or name another file as store");
}

}  // namespace

StateFile::StateFile(const std::string& path) : file_(path) {
  if (file_.size() < magic.size() + 3 * 8 || file_.text().substr(0, magic.size()) != magic) fail(path, "is not the state of a run");
  uint64_t sum = 0;
  std::memcpy(&sum, file_.data() + file_.size() - sum_bytes, sum_bytes);
  if (XXH64(file_.data(), file_.size() - sum_bytes, 0) != sum) fail(path, "is damaged: its sum is another one");
  at_ = magic.size();
  const std::span<const std::byte> key = next(), frame = next();
  key_.assign(reinterpret_cast<const char*>(key.data()), key.size());
  if (frame.size() != sizeof frame_) fail_length();
  std::memcpy(&frame_, frame.data(), sizeof frame_);
}

std::span<const std::byte> StateFile::next() {
  const size_t end = file_.size() - sum_bytes;
  uint64_t bytes = 0;
  if (end - at_ < sizeof bytes) fail_length();
  std::memcpy(&bytes, file_.data() + at_, sizeof bytes);
  at_ += sizeof bytes;
  if (bytes > end - at_) fail_length();
  const std::span<const std::byte> part(file_.data() + at_, bytes);
  at_ += bytes;
  return part;
}

void StateFile::fail_length() const { fail(file_.path(), "holds parts of other sizes than this run has"); }

struct StateWriter::Sum {
  XXH64_state_t* state = XXH64_createState();
  ~Sum() { XXH64_freeState(state); }
};

StateWriter::StateWriter(const std::string& path, const std::string& key, uint64_t frame) : file_(path), sum_(std::make_unique<Sum>()) {
  XXH64_reset(sum_->state, 0);
  write(magic.data(), magic.size());
  add(key.data(), key.size());
  add(&frame, sizeof frame);
}

StateWriter::~StateWriter() = default;

void StateWriter::write(const void* data, size_t bytes) {
  XXH64_update(sum_->state, data, bytes);
  file_.write(data, bytes);
}

void StateWriter::add(const void* data, size_t bytes) {
  const uint64_t size = bytes;
  write(&size, sizeof size);
  write(data, bytes);
}

void StateWriter::commit() {
  const uint64_t sum = XXH64_digest(sum_->state);
  file_.write(&sum, sum_bytes);
  file_.commit();
}

}  // namespace sg
