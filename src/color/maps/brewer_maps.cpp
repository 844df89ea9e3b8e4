// SPDX-License-Identifier: Apache-2.0
// The colours that ColorBrewer lists for its largest number of classes (Cynthia A. Brewer, colorbrewer2.org, Apache 2.0), and the ten and
// twenty colours of Tableau 10 and 20 as Matplotlib lists them under their names.
#include "color/maps/brewer_maps.h"

namespace sg {

namespace {

constexpr PublishedMap brewer[] = {
    {"Blues", MapKind::sequential, "White to dark blue (ColorBrewer, Brewer 2002).",
     "f7fbffdeebf7c6dbef9ecae16baed64292c62171b508519c08306b"},
    {"Greens", MapKind::sequential, "White to dark green (ColorBrewer, Brewer 2002).",
     "f7fcf5e5f5e0c7e9c0a1d99b74c47641ab5d238b45006d2c00441b"},
    {"Greys", MapKind::sequential, "White to black (ColorBrewer, Brewer 2002).", "fffffff0f0f0d9d9d9bdbdbd969696737373525252252525000000"},
    {"Oranges", MapKind::sequential, "White to brown over orange (ColorBrewer, Brewer 2002).",
     "fff5ebfee6cefdd0a2fdae6bfd8d3cf16913d94801a636037f2704"},
    {"Purples", MapKind::sequential, "White to dark purple (ColorBrewer, Brewer 2002).",
     "fcfbfdefedf5dadaebbcbddc9e9ac8807dba6a51a354278f3f007d"},
    {"Reds", MapKind::sequential, "White to dark red (ColorBrewer, Brewer 2002).",
     "fff5f0fee0d2fcbba1fc9272fb6a4aef3b2ccb181da50f1567000d"},
    {"YlOrRd", MapKind::sequential, "Yellow over orange to dark red (ColorBrewer, Brewer 2002).",
     "ffffccffeda0fed976feb24cfd8d3cfc4e2ae31a1cbd0026800026"},
    {"YlOrBr", MapKind::sequential, "Yellow over orange to brown (ColorBrewer, Brewer 2002).",
     "ffffe5fff7bcfee391fec44ffe9929ec7014cc4c02993404662506"},
    {"YlGnBu", MapKind::sequential, "Yellow over green to dark blue (ColorBrewer, Brewer 2002).",
     "ffffd9edf8b1c7e9b47fcdbb41b6c41d91c0225ea8253494081d58"},
    {"YlGn", MapKind::sequential, "Yellow to dark green (ColorBrewer, Brewer 2002).",
     "ffffe5f7fcb9d9f0a3addd8e78c67941ab5d238443006837004529"},
    {"OrRd", MapKind::sequential, "Cream over orange to dark red (ColorBrewer, Brewer 2002).",
     "fff7ecfee8c8fdd49efdbb84fc8d59ef6548d7301fb300007f0000"},
    {"PuRd", MapKind::sequential, "White over purple to dark red (ColorBrewer, Brewer 2002).",
     "f7f4f9e7e1efd4b9dac994c7df65b0e7298ace125698004367001f"},
    {"RdPu", MapKind::sequential, "White over pink to purple (ColorBrewer, Brewer 2002).",
     "fff7f3fde0ddfcc5c0fa9fb5f768a1dd3497ae017e7a017749006a"},
    {"BuPu", MapKind::sequential, "Pale blue to purple (ColorBrewer, Brewer 2002).",
     "f7fcfde0ecf4bfd3e69ebcda8c96c68c6bb188419d810f7c4d004b"},
    {"GnBu", MapKind::sequential, "Pale green to blue (ColorBrewer, Brewer 2002).",
     "f7fcf0e0f3dbccebc5a8ddb57bccc44eb3d32b8cbe0868ac084081"},
    {"PuBu", MapKind::sequential, "White to blue over violet (ColorBrewer, Brewer 2002).",
     "fff7fbece7f2d0d1e6a6bddb74a9cf3690c00570b0045a8d023858"},
    {"PuBuGn", MapKind::sequential, "White over blue to dark green (ColorBrewer, Brewer 2002).",
     "fff7fbece2f0d0d1e6a6bddb67a9cf3690c002818a016c59014636"},
    {"BuGn", MapKind::sequential, "Pale blue to dark green (ColorBrewer, Brewer 2002).",
     "f7fcfde5f5f9ccece699d8c966c2a441ae76238b45006d2c00441b"},
    {"RdBu", MapKind::diverging, "Red over white to blue, for maps and print (ColorBrewer, Brewer 2002).",
     "67001fb2182bd6604df4a582fddbc7f7f7f7d1e5f092c5de4393c32166ac053061"},
    {"RdYlBu", MapKind::diverging, "Red over yellow to blue (ColorBrewer, Brewer 2002).",
     "a50026d73027f46d43fdae61fee090ffffbfe0f3f8abd9e974add14575b4313695"},
    {"BrBG", MapKind::diverging, "Brown over white to blue-green (ColorBrewer, Brewer 2002).",
     "5430058c510abf812ddfc27df6e8c3f5f5f5c7eae580cdc135978f01665e003c30"},
    {"Spectral", MapKind::diverging, "Red over yellow to blue by the hues between (ColorBrewer, Brewer 2002).",
     "9e0142d53e4ff46d43fdae61fee08bffffbfe6f598abdda466c2a53288bd5e4fa2"},
    {"PuOr", MapKind::diverging, "Brown-orange over white to purple (ColorBrewer, Brewer 2002).",
     "7f3b08b35806e08214fdb863fee0b6f7f7f7d8daebb2abd28073ac5427882d004b"},
    {"PRGn", MapKind::diverging, "Purple over white to green (ColorBrewer, Brewer 2002).",
     "40004b762a839970abc2a5cfe7d4e8f7f7f7d9f0d3a6dba05aae611b783700441b"},
    {"PiYG", MapKind::diverging, "Pink over white to green (ColorBrewer, Brewer 2002).",
     "8e0152c51b7dde77aef1b6dafde0eff7f7f7e6f5d0b8e1867fbc414d9221276419"},
    {"RdGy", MapKind::diverging, "Red over white to grey (ColorBrewer, Brewer 2002).",
     "67001fb2182bd6604df4a582fddbc7ffffffe0e0e0bababa8787874d4d4d1a1a1a"},
    {"RdYlGn", MapKind::diverging,
     "Red over yellow to green; red-green blind readers cannot tell its sides apart (ColorBrewer, Brewer 2002).",
     "a50026d73027f46d43fdae61fee08bffffbfd9ef8ba6d96a66bd631a9850006837"},
    {"Set1", MapKind::categorical, "Nine strong colours for names (ColorBrewer, Brewer 2002).",
     "e41a1c377eb84daf4a984ea3ff7f00ffff33a65628f781bf999999"},
    {"Set2", MapKind::categorical, "Eight soft colours for names (ColorBrewer, Brewer 2002).",
     "66c2a5fc8d628da0cbe78ac3a6d854ffd92fe5c494b3b3b3"},
    {"Set3", MapKind::categorical, "Twelve pale colours for names (ColorBrewer, Brewer 2002).",
     "8dd3c7ffffb3bebadafb807280b1d3fdb462b3de69fccde5d9d9d9bc80bdccebc5ffed6f"},
    {"Dark2", MapKind::categorical, "Eight dark colours for names (ColorBrewer, Brewer 2002).",
     "1b9e77d95f027570b3e7298a66a61ee6ab02a6761d666666"},
    {"Paired", MapKind::categorical, "Six pairs of a pale and a strong colour for names (ColorBrewer, Brewer 2002).",
     "a6cee31f78b4b2df8a33a02cfb9a99e31a1cfdbf6fff7f00cab2d66a3d9affff99b15928"},
    {"Accent", MapKind::categorical, "Eight colours, some of them accents for names (ColorBrewer, Brewer 2002).",
     "7fc97fbeaed4fdc086ffff99386cb0f0027fbf5b17666666"},
    {"Pastel1", MapKind::categorical, "Nine very pale colours for names (ColorBrewer, Brewer 2002).",
     "fbb4aeb3cde3ccebc5decbe4fed9a6ffffcce5d8bdfddaecf2f2f2"},
    {"Pastel2", MapKind::categorical, "Eight very pale colours for names (ColorBrewer, Brewer 2002).",
     "b3e2cdfdcdaccbd5e8f4cae4e6f5c9fff2aef1e2cccccccc"},
    {"tab10", MapKind::categorical, "Ten colours for names (Tableau; the default of Matplotlib).",
     "1f77b4ff7f0e2ca02cd627289467bd8c564be377c27f7f7fbcbd2217becf"},
    {"tab20", MapKind::categorical, "Ten pairs of a strong and a pale colour for names (Tableau; Matplotlib).",
     "1f77b4aec7e8ff7f0effbb782ca02c98df8ad62728ff98969467bdc5b0d58c564bc49c94e377c2f7b6d27f7f7fc7c7c7bcbd22dbdb8d"
     "17becf9edae5"},
};

}  // namespace

std::span<const PublishedMap> brewer_maps() { return brewer; }

}  // namespace sg
