// SPDX-License-Identifier: Apache-2.0
#include "color/published_maps.h"

namespace sg {

namespace {

// Colours in hexadecimal, six digits each, evenly spaced. Of tables of 256 every fifth is kept; between them the tables are straight within
// four steps of 8 bits.
constexpr PublishedMap maps[] = {
    {"viridis", MapKind::sequential, "Violet over blue and green to yellow (van der Walt, Smith 2015; Matplotlib, CC0).",
     "44015446085c471063481769481d6f482475472a7a46307e453781433d844142873f48893d4e8a3a538b38598c355e8d33638d31688e"
     "2e6d8e2c718e2a768e297b8e27808e25848e23898e218e8d20928c1f978b1e9c891fa18821a58524aa8328ae802eb37c35b7793dbc74"
     "46c06f50c46a5ac86465cb5e70cf577cd25089d54895d840a2da37b0dd2fbddf26cae11fd8e219e5e419f1e51dfde725"},
    {"magma", MapKind::sequential, "Black over purple and red to pale yellow (van der Walt, Smith 2015; Matplotlib, CC0).",
     "00000402020b0504160907200e0b2b140e361a104221114e29115a311165390f6e420f754a107952137c5a167e6219806a1c81721f81"
     "792282812581892881912b81992d80a1307eaa337db2357bba3878c23b75ca3e72d2426fd9466be04c67e75263ec5860f1605df4695c"
     "f7725cf97b5dfb8560fc8e64fd9869fea16efeaa74feb47bfebd82fec68afecf92fed89afde2a3fdebacfcf4b6fcfdbf"},
    {"inferno", MapKind::sequential, "Black over purple and orange to pale yellow (van der Walt, Smith 2015; Matplotlib, CC0).",
     "00000402020c0504170a072210092d160b391e0c45260c512f0a5b380962400a67490b6a510e6c59106e61136e69166e71196e781c6d"
     "801f6c88226a902568982766a02a63a82e5fb0315bb73557bf3952c63d4dcc4248d34743d94d3ddf5337e45a31e9612bed6925f1711f"
     "f47918f78212f98b0bfa9407fb9d07fca60cfcb014fbba1ffac42af8cd37f6d746f4e156f2ea69f2f27df5f992fcffa4"},
    {"plasma", MapKind::sequential, "Blue over purple and orange to yellow (van der Walt, Smith 2015; Matplotlib, CC0).",
     "0d08871b068d2605912f059638049a41049d4903a05102a35901a56100a76900a87100a87801a88004a88707a68e0ca49511a19c179e"
     "a21d9aa82296ae2892b42e8dba3388bf3984c43e7fc9447acd4a76d24f71d6556dda5b69de6164e26660e66c5ce97257ed7953f07f4f"
     "f3854bf58c46f79342f99a3efba139fca835fdaf31feb72dfebe2afdc627fcce25fbd724f8df25f6e826f3f027f0f921"},
    {"cividis", MapKind::sequential,
     "Blue over grey to yellow, the same to readers with and without red-green blindness (Nunez et al. 2018).",
     "00224e002656002a5f002d68003070083370163770203a6f273e6e2e416d34456c3a486c3f4c6c444f6c49536c4e566c535a6d575d6d"
     "5c616e60646f656870696b716d6f727272747676767a7a787e7d788381798885788d8878928c789690779b9476a09875a59c74aaa073"
     "afa471b5a86fbaac6dbfb06bc4b468c9b965cfbd62d4c15fdac65bdfca57e5cf52ead34cf0d846f6dd3ffce236fee838"},
    {"batlow", MapKind::sequential, "Dark blue over green and orange to pink, even in lightness (Crameri 2018).",
     "01195906215b0a285c0c2f5d0e365e0f3c5f114160124661134b61154f621854621b58621e5d6223606028645f2f675c356a593c6d56"
     "4470524c724d5375495b7745637a406c7c3c747e387d81348683308f862d99882ca38a2cad8c2db78e31c09036ca923cd29343db954b"
     "e39754ea995ef09c69f59f74f9a380fba68cfdaa97fdaea2fdb2adfdb5b8fdb9c2fdbccdfcc0d8fcc4e3fbc8effaccfa"},
    {"vik", MapKind::diverging, "Blue over white to red-brown, for values about a centre (Crameri 2018).",
     "001261011a6602226b022a7002317502397a03417f03498405518908598f106294196b9a2575a1327ea74188ae5093b5609dbc70a7c3"
     "7fb1ca8fbbd19fc5d7afcedebfd7e4cee0e8dde6e9e8e7e6eee2dbeedacfecd1c2e8c7b4e4bda7dfb399dba98cd7a080d39673cf8d67"
     "cc845cc87c50c47344c06b3abc622fb65723af4c18a5400f9a35088f2b068522067c1b067314066a0d07620607590008"},
    {"twilight", MapKind::cyclic, "White over blue, black and red to white, for angles and phases (Bechtold 2017; Matplotlib).",
     "e2d9e2dcd9dfd2d5dbc5cfd5b6c8cfa7c0cb99b8c88cafc580a6c3779cc26f92c06888be647ebc6173ba6067b65f5cb25e50ac5e44a5"
     "5c389c5a2c915621835019734814623f125238114432123b32123739113a43123e4e14445b1749681a4d751e4f8224508d2b50973450"
     "a13e50a94850b05352b75f54bc6a59c1765fc48367c78f72ca9b7fcda78ed0b39ed4beafd9c8c0ddd0cfe0d7dbe2d9e2"},
    {"turbo", MapKind::unsafe, "A smoother rainbow (Mikhailov 2019): its lightness rises to the middle and falls again.",
     "30123b36215f3b2f803f3e9c424bb54559cb4666dd4773eb4680f6458cfd4099ff38a5fb2fb2f427bee91fc9dd1ad4d018ddc21ae4b6"
     "22ebaa2ff19b3ff68a52fa7a65fd6979fe598bff4b9cfe40a9fb39b7f735c3f134d0ea34dbe236e5d938eecf3af5c53afaba39fdae35"
     "fea130fe932afc8423f9751df46617ef5811e84b0ce14109d83706ce2d04c32503b71d02a916019b0f018b09027a0403"},
};

}  // namespace

std::span<const PublishedMap> published_maps() { return maps; }

std::vector<Vec3f> colors_of(const PublishedMap& map) {
  const auto digit = [](char c) { return c <= '9' ? c - '0' : c - 'a' + 10; };
  std::vector<Vec3f> colors;
  for (size_t i = 0; i + 6 <= map.colors.size(); i += 6) {
    const auto channel = [&](size_t k) { return float(16 * digit(map.colors[i + 2 * k]) + digit(map.colors[i + 2 * k + 1])) / 255; };
    colors.push_back({channel(0), channel(1), channel(2)});
  }
  return colors;
}

}  // namespace sg
