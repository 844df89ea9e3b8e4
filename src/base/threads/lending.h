// SPDX-License-Identifier: Apache-2.0
// Lending: things that one thread at a time may use, made when nobody has given one back.
#pragma once
#include <functional>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace sg {

/// Must outlive what it lends.
template <class T>
class Lending {
 public:
  explicit Lending(std::function<std::unique_ptr<T>()> make) : make_(std::move(make)) {}

  struct Return {
    const Lending* to = nullptr;
    void operator()(T* thing) const {
      std::unique_ptr<T> owned(thing);
      const std::lock_guard lock(to->mutex_);
      to->idle_.push_back(std::move(owned));
    }
  };
  using Loan = std::unique_ptr<T, Return>;
  Loan borrow() const {
    {
      const std::lock_guard lock(mutex_);
      if (!idle_.empty()) {
        std::unique_ptr<T> thing = std::move(idle_.back());
        idle_.pop_back();
        return Loan(thing.release(), Return{this});
      }
    }
    return Loan(make_().release(), Return{this});
  }

 private:
  std::function<std::unique_ptr<T>()> make_;
  mutable std::mutex mutex_;
  mutable std::vector<std::unique_ptr<T>> idle_;
};

}  // namespace sg
