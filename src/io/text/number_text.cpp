// SPDX-License-Identifier: Apache-2.0
#include "io/text/number_text.h"

#include "io/text/text_scan.h"

namespace sg {

ElementType real_type_of(std::string_view text) {
  text = text.substr(0, 1 << 16);
  int digits = 0;  // significant ones of the number at hand
  bool exponent = false;
  int zeros = 0;
  for (const char c : text) {
    if (is_digit(c)) {
      if (exponent) continue;
      if (c == '0') {
        if (digits > 0) ++zeros;  // counts only when another digit follows
      } else {
        digits += zeros + 1, zeros = 0;
        if (digits > 7) return ElementType::f64;
      }
    } else if (c == 'e' || c == 'E' || c == 'd' || c == 'D') {
      exponent = true;
    } else if (c != '.') {
      if ((c == '-' || c == '+') && exponent) continue;
      digits = 0, zeros = 0, exponent = false;
    }
  }
  return ElementType::f32;
}

}  // namespace sg
