// SPDX-License-Identifier: Apache-2.0
// Tokens, users, rates and names of hosts, each by itself.
#include <sys/stat.h>

#include <set>

#include "base/file/file.h"
#include "serve/guard/host_check.h"
#include "serve/guard/rate.h"
#include "serve/guard/sha256.h"
#include "serve/guard/token.h"
#include "serve/guard/users.h"
#include "serve/guard/visitors.h"
#include "support/test.h"

namespace sg {

using namespace serve;
using test::contains;
using test::error_of;

TEST_CASE("sha256: the examples of FIPS 180-4, and all lengths around a block") {
  CHECK(sha256_hex("") == "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  CHECK(sha256_hex("abc") == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  CHECK(sha256_hex("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq") ==
        "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  CHECK(sha256_hex(std::string(1'000'000, 'a')) == "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
  std::set<std::string> sums;
  for (size_t n = 0; n <= 130; ++n) sums.insert(sha256_hex(std::string(n, 'x')));
  CHECK(sums.size() == 131);
}

TEST_CASE("tokens: 43 signs, never the same, all 64 signs occur; compared whole") {
  std::set<std::string> tokens;
  std::set<char> signs;
  for (int i = 0; i < 200; ++i) {
    const std::string token = new_token();
    CHECK(token.size() == 43);
    tokens.insert(token);
    signs.insert(token.begin(), token.end());
  }
  CHECK(tokens.size() == 200);
  CHECK(signs.size() == 64);
  CHECK(same_secret("abc", "abc"));
  CHECK_FALSE(same_secret("abc", "abd"));
  CHECK_FALSE(same_secret("abc", "abcd"));
  CHECK_FALSE(same_secret("abc", ""));
}

TEST_CASE("users: a file of users gives back what user_line wrote, and what is wrong is named by its line") {
  const std::string anna = new_token(), ben = new_token();
  const auto users = parse_users("# people\n\n" + user_line("anna", Rights::edit, anna) + user_line("ben@lab", Rights::view, ben), "users");
  REQUIRE(users.size() == 2);
  CHECK(users[0].name == "anna");
  CHECK(users[0].rights == Rights::edit);
  CHECK(users[1].rights == Rights::view);
  CHECK(users[1].hash == token_hash(ben));
  CHECK_FALSE(contains(user_line("anna", Rights::edit, anna), anna));

  const std::string good = user_line("anna", Rights::edit, anna);
  CHECK(contains(error_of([&] { parse_users(good + "anna edit\n", "u"); }), "u, line 2: has 2 words"));
  CHECK(contains(error_of([&] { parse_users("anna all " + token_hash(ben), "u"); }), "neither 'view' nor 'edit'"));
  CHECK(contains(error_of([&] { parse_users("anna edit sha256:12", "u"); }), "the hash is none"));
  CHECK(contains(error_of([&] { parse_users("an<na edit " + token_hash(ben), "u"); }), "the name is none"));
  CHECK(contains(error_of([&] { parse_users(good + "anna view " + token_hash(ben), "u"); }), "'anna' comes twice"));
  CHECK(contains(error_of([&] { parse_users(good + "ben view " + token_hash(anna), "u"); }), "the same token"));
  CHECK(contains(error_of([&] { user_line("a b", Rights::view, anna); }), "cannot be the name"));
}

TEST_CASE("users: a file that others may write is refused") {
  const std::string path = test::fresh_folder("users") + "users";
  write_file(path, user_line("anna", Rights::edit, new_token()));
  ::chmod(path.c_str(), 0644);
  CHECK(read_users(path).size() == 1);
  ::chmod(path.c_str(), 0664);
  CHECK(contains(error_of([&] { read_users(path); }), "others than its owner may write it"));
}

TEST_CASE("visitors: the token of one counts once, those of users any number of times, each with its rights") {
  Visitors one({});
  CHECK_FALSE(one.enter("").has_value());
  CHECK_FALSE(one.enter(one.token().substr(1)).has_value());
  const auto secret = one.enter(one.token());
  REQUIRE(secret.has_value());
  CHECK_FALSE(one.enter(one.token()).has_value());
  CHECK(one.visitor(*secret).has_value());
  CHECK(one.visitor(*secret)->rights == Rights::edit);
  CHECK_FALSE(one.visitor("").has_value());
  CHECK_FALSE(one.visitor(one.token()).has_value());

  const std::string anna = new_token(), ben = new_token();
  Visitors many(parse_users(user_line("anna", Rights::edit, anna) + user_line("ben", Rights::view, ben), "users"));
  CHECK(many.token().empty());
  CHECK_FALSE(many.enter("").has_value());
  CHECK_FALSE(many.enter(token_hash(anna)).has_value());
  CHECK(many.visitor(*many.enter(anna))->user == "anna");
  CHECK(many.visitor(*many.enter(ben))->rights == Rights::view);
  const auto first = many.enter(anna);
  for (int i = 0; i < 4096; ++i) CHECK(many.enter(ben).has_value());
  CHECK_FALSE(many.visitor(*first).has_value());  // secrets are not kept without end
}

TEST_CASE("rate: so many at once, then so many a second") {
  Rate::Clock::time_point now{};
  Rate rate(10, now);
  for (int i = 0; i < 10; ++i) CHECK(rate.take(now));
  CHECK_FALSE(rate.take(now));
  CHECK(rate.wait() >= std::chrono::milliseconds(100));
  now += rate.wait();
  CHECK(rate.take(now));
  CHECK_FALSE(rate.take(now));
  now += std::chrono::hours(1);
  int taken = 0;
  while (rate.take(now)) ++taken;
  CHECK(taken == 10);
}

TEST_CASE("hosts: of loopback its three names with the port, in letters of any size") {
  const HostCheck hosts("127.0.0.1", 8234, {});
  for (const char* host : {"127.0.0.1:8234", "localhost:8234", "LocalHost:8234", "[::1]:8234"}) CHECK(hosts.origin_of(host).has_value());
  for (const char* host :
       {"", "localhost", "127.0.0.1", "localhost:8235", "localhost:", "localhost.:8234", "evil.example:8234", "127.0.0.1.evil.example:8234",
        "localhost:8234 ", "localhost:8234:8234", "127.0.0.1:08234", "127.1:8234", "2130706433:8234", "0.0.0.0:8234",
        "[::ffff:127.0.0.1]:8234", "::1:8234", "user@localhost:8234", "localhost:8234/"})
    CHECK_MESSAGE(!hosts.origin_of(host).has_value(), host);
  CHECK(hosts.is_ours("localhost:8234", "http://localhost:8234"));
  // A page by another of our names is another page to the browser: it has no reason to ask here.
  CHECK_FALSE(hosts.is_ours("localhost:8234", "http://127.0.0.1:8234"));
  for (const char* origin : {"", "null", "http://localhost", "https://localhost:8234", "http://localhost:8234/", "http://LOCALHOST:8234",
                             "http://localhost:8234.evil.example", "http://evil.example"})
    CHECK_MESSAGE(!hosts.is_ours("localhost:8234", origin), origin);
}

TEST_CASE("hosts: the usual port may be missing; public origins count beside the address; of all addresses none is ours") {
  const HostCheck usual("127.0.0.1", 80, {});
  CHECK(usual.is_ours("localhost", "http://localhost"));
  CHECK(usual.is_ours("localhost:80", "http://localhost"));
  const HostCheck proxied("127.0.0.1", 8234, {"https://view.example.org", "https://lab.example.org:8443"});
  CHECK(proxied.origins().front() == "https://view.example.org");
  CHECK(proxied.is_ours("view.example.org", "https://view.example.org"));
  CHECK(proxied.is_ours("view.example.org:443", "https://view.example.org"));
  CHECK(proxied.is_ours("lab.example.org:8443", "https://lab.example.org:8443"));
  CHECK_FALSE(proxied.is_ours("view.example.org", "http://view.example.org"));
  CHECK_FALSE(proxied.origin_of("lab.example.org").has_value());
  CHECK(proxied.origin_of("localhost:8234").has_value());
  const HostCheck all("0.0.0.0", 8234, {});
  CHECK_FALSE(all.origin_of("0.0.0.0:8234").has_value());
  CHECK(all.origin_of("localhost:8234").has_value());
  const HostCheck six("fe80::1", 8234, {});
  CHECK(six.origin_of("[fe80::1]:8234").has_value());
  CHECK_FALSE(six.origin_of("localhost:8234").has_value());
  for (const char* origin : {"view.example.org", "https://", "https://view.example.org/", "https://View.example.org", "https://a:b",
                             "ftp://a", "https://*.example.org", "https://a:0", "https://a.", "https://[::1", "https://a b"})
    CHECK_MESSAGE(contains(error_of([&] { HostCheck("127.0.0.1", 1, {origin}); }), "is no origin"), origin);
}

}  // namespace sg
