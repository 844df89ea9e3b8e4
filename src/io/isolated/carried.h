// SPDX-License-Identifier: Apache-2.0
// Data as bytes that another process understands: numbers and texts one after the other, arrays by the place where they lie. For
// processes of one program (io/isolated/isolated.h), never for files: neither byte order nor layout is kept from version to version.
#pragma once
#include <cstring>
#include <map>

#include "data/dataset.h"

namespace sg {

/// Describes data in `text` and collects its arrays, which are to lie one after the other, each at a multiple of 64 bytes. Arrays that
/// several parts share are listed once.
class CarryWriter {
 public:
  std::string text;
  std::vector<Array> arrays;

  template <class T>
  void number(T v) {
    static_assert(std::is_trivially_copyable_v<T>);
    text.append(reinterpret_cast<const char*>(&v), sizeof v);
  }
  void string(std::string_view s);
  void data(const Data& d);

 private:
  void array(const Array& a);
  void field(const Field& f);
  void mesh(const Mesh& m);
  void dataset(const Dataset& d);
  size_t array_bytes_ = 0;
  struct Place {
    Array array;
    size_t offset;
  };
  std::map<const std::byte*, std::vector<Place>> placed_;
};

/// Understands it again. Throws Error(data) naming `path` for anything no writer produces: the writing process may have been corrupted.
class CarryReader {
 public:
  /// The description is file[begin, end), the arrays lie from `arrays` on.
  CarryReader(Buffer file, size_t begin, size_t end, size_t arrays, std::string path);

  template <class T>
  T number() {
    static_assert(std::is_trivially_copyable_v<T>);
    need(sizeof(T));
    T v;
    std::memcpy(&v, file_.data + at_, sizeof v);
    at_ += sizeof v;
    return v;
  }
  std::string string();
  Data data();

 private:
  void need(size_t bytes) const {
    if (bytes > end_ - at_) nonsense();
  }
  [[noreturn]] void nonsense() const;
  template <class E>
  E one_of(E last);
  Array array();
  Points points();
  CellArray cells();
  Field field();
  Mesh mesh();
  DatasetPtr dataset();
  Buffer file_;
  size_t at_, end_, arrays_;
  std::string path_;
  int depth_ = 0;
};

}  // namespace sg
