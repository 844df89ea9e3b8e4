// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "image/linear_picture.h"
#include "support/test.h"

using namespace sg;
using doctest::Approx;

namespace {

std::string header(const std::string& size, const std::string& lines = "FORMAT=32-bit_rle_rgbe\n") {
  return "#?RADIANCE\n" + lines + "\n" + size + "\n";
}
LinearPicture decode(const std::string& bytes) { return decode_hdr(std::as_bytes(std::span(bytes)), "a.hdr"); }
std::string refusal(const std::string& bytes) {
  return test::error_of([&] { decode(bytes); });
}
std::string text(std::initializer_list<int> bytes) {
  std::string s;
  for (const int b : bytes) s += char(b);
  return s;
}

// Eight pixels: red 128, then 64 three times over and 32 one by one; green and blue 0; exponents of 1.
const std::string row = text({2, 2, 0, 8, 1, 128, 131, 64, 4, 32, 33, 34, 35, 136, 0, 136, 0, 136, 129});

}  // namespace

TEST_CASE("hdr: rows as runs, pixel by pixel and with repeated pixels, by their exponents and exposure") {
  const LinearPicture p = decode(header("-Y 2 +X 8") + row + row);
  CHECK(p.width == 8);
  CHECK(p.height == 2);
  // (mantissa + 1/2) 2^(exponent - 136).
  CHECK(p.pixels[0].x == Approx(128.5 / 128));
  CHECK(p.pixels[3].x == Approx(64.5 / 128));
  CHECK(p.pixels[15].x == Approx(35.5 / 128));
  CHECK(p.pixels[0].y == Approx(0.5 / 128));
  const std::string pixel = text({128, 64, 32, 129}), dark = text({9, 9, 9, 0});
  const LinearPicture flat =
      decode(header("-Y 1 +X 2", "FORMAT=32-bit_rle_rgbe\nEXPOSURE=2\nEXPOSURE= 2\nCOLORCORR=1 2 1\n") + pixel + dark);
  CHECK(flat.pixels[0].x == Approx(128.5 / 128 / 4));
  CHECK(flat.pixels[0].y == Approx(64.5 / 128 / 8));
  CHECK(flat.pixels[1] == Vec3f());
  // 1, 1, 1, n: the last one n times more, and n 256 at once behind that.
  const LinearPicture old = decode(header("-Y 1 +X 260") + pixel + text({1, 1, 1, 3, 1, 1, 1, 1}));
  CHECK(old.pixels[259].x == Approx(128.5 / 128));
}

TEST_CASE("hdr: files that are cut, damaged or too large for their bytes are refused") {
  const std::string whole = header("-Y 2 +X 8") + row + row;
  for (size_t n = 0; n < whole.size(); ++n) CHECK(refusal(whole.substr(0, n)).find("a.hdr") != std::string::npos);
  CHECK(test::contains(refusal("P6"), "cut off"));
  CHECK(test::contains(refusal("P6\n1 1\n"), "not a Radiance"));
  CHECK(test::contains(refusal(header("-Y 2 +X 8", "FORMAT=32-bit_rle_xyze\n") + row), "xyze"));
  CHECK(test::contains(refusal(header("+X 8 -Y 2") + row), "top left"));
  CHECK(test::contains(refusal(header("-Y 0 +X 8")), "0 pixels"));
  CHECK(test::contains(refusal(header("-Y 99999 +X 8")), "99999"));
  CHECK(test::contains(refusal(header("-Y 32768 +X 32768")), "more than a file"));
  CHECK(test::contains(refusal(header("-Y 1 +X 8", "EXPOSURE=0\n") + row), "exposure"));
  // A run that is longer than its row, of no length, and one of another row's length.
  CHECK(test::contains(refusal(header("-Y 1 +X 8") + text({2, 2, 0, 8, 137, 0, 0, 0})), "beyond"));
  CHECK(test::contains(refusal(header("-Y 1 +X 8") + text({2, 2, 0, 8, 0, 0, 0, 0})), "beyond"));
  CHECK(test::contains(refusal(header("-Y 1 +X 8") + text({2, 2, 0, 9, 137, 0, 0, 0})), "another length"));
  CHECK(test::contains(refusal(header("-Y 1 +X 4") + text({1, 1, 1, 3})), "beyond"));
}
