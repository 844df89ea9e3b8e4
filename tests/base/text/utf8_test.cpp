// SPDX-License-Identifier: Apache-2.0
#include "base/text/utf8.h"

#include "base/text/text.h"
#include "support/property.h"
#include "support/test.h"

using namespace sg;

TEST_CASE("text for terminals shows what would act") {
  CHECK(printable("T\xc3\xa9 \xe2\x84\xab") == "T\xc3\xa9 \xe2\x84\xab");
  CHECK(printable("\x1b[31mred\x07\x7f") == "\\x1b[31mred\\x07\\x7f");
  CHECK(printable("a\nb\tc\r") == "a\\nb\\tc\\r");
  CHECK(printable("a\nb", true) == "a\nb");
  CHECK(printable("\xff\xc0\x80 \xc2\x9b") == "\\xff\\xc0\\x80 \\x9b");  // 0x9b begins a sequence, as ESC [ does
  CHECK(printable("\xe2\x80\xae"
                  "fdp.exe") ==
        "\\u202e"
        "fdp.exe");
  CHECK(printable(std::string("a\0b", 3)) == "a\\x00b");
}

TEST_CASE("JSON strings are ASCII controls escaped and UTF-8, whatever the bytes") {
  CHECK(json_string("a\"\\\n\x1b\x7f") == "\"a\\\"\\\\\\n\\u001b\\u007f\"");
  CHECK(json_string("\xe2\x80\xae") == "\"\\u202e\"");
  CHECK(json_string("\xf3\xa0\x80\x81") == "\"\\udb40\\udc01\"");
  CHECK(is_utf8(json_string("\xff\xfe")));
}

TEST_CASE("property: any bytes survive as text, and text for terminals and JSON has no control character and is UTF-8") {
  for (uint64_t seed : test::property_seeds(300)) {
    CAPTURE(seed);
    test::Random random(seed);
    std::string s;
    for (int n = random.whole(0, 40); n > 0; --n) {
      if (random.chance(0.3)) s += char(random.whole(0, 255));
      else if (random.chance(0.3))
        append_utf8(s, uint32_t(random.one_of({0xef7f, 0xef80, 0xefff, 0xf000, 0x202e, 0x1f600, 0xe0041, 0x7ff, 0x800, 0xfffd})));
      else s += char(random.whole(32, 126));
    }
    const std::string text = text_of_bytes(s);
    CHECK(is_utf8(text));
    CHECK(bytes_of_text(text) == s);
    for (const std::string& shown : {printable(s), json_string(s)}) {
      CHECK(is_utf8(shown));
      for (size_t i = 0, n = 0; i < shown.size(); i += n) {
        uint32_t code = 0;
        n = decode_utf8(shown, i, code);
        REQUIRE(n > 0);
        CHECK_FALSE(is_control(code));
      }
    }
  }
}
