// SPDX-License-Identifier: Apache-2.0
#include "scene/show/other_names.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "base/text/text.h"

namespace sg {

namespace {

constexpr OtherName names[] = {
    {"contour isosurface isosurfaces iso isocontour isovalue marchingcubes flyingedges contours levelset", "-f 'contour values=...'"},
    {"isolines contourlines isoline levels", "-f 'isolines count=10'"},
    {"filledcontours bandedcontour contourf", "-f 'bands count=10'"},
    {"slice cut cutter cutplane plane section slices crosssection orthoslice", "-f 'slice axis=z'"},
    {"clip halfspace cutaway clipplane", "-f 'clip axis=z'"},
    {"glyph arrow arrows quiver quivers vectors hedgehog glyph3d", "--show glyphs"},
    {"streamlines streamline streamtracer stream flowlines fieldlines integralcurves", "-f streamlines"},
    {"pathline particletracer trajectories", "-f pathlines"},
    {"tubes tube tubefilter", "-f tubes"},
    {"ribbon ribbonfilter", "-f ribbons"},
    {"wireframe wire mesh gridlines", "--show 'surface style=wireframe'"},
    {"edges grid", "--show 'surface edges=true'"},
    {"outline boundingbox box bounds frame", "--show outline"},
    {"points pointcloud scatter scatterplot vertices dots point", "--show points"},
    {"surface solid shaded", "--show surface"},
    {"extractsurface skin boundary outersurface externalfaces geometry datasetsurface hull", "-f faces"},
    {"connectivity connectedcomponents regions islands", "-f components"},
    {"subset extractsubset voi subvolume extractvoi", "-f crop"},
    {"calculator expression formula math", "-f 'calc expr=...'"},
    {"height elevationfilter", "-f elevation"},
    {"linearextrusion rotationalextrusion sweep", "-f 'extrude direction=0,0,1'"},
    {"warpbyvector warpbyscalar warpvector warpscalar deform displace displacement terrain relief", "-f warp"},
    {"reflect reflection symmetry", "-f 'mirror axis=x'"},
    {"flip", "-f 'transform scale=-1,1,1'"},
    {"exaggeration verticalexaggeration zscale aspect", "--picture stretch=1,1,10"},
    {"rotate translate move rescale", "-f transform"},
    {"triangulate tetrahedralize triangles linearize refine", "-f tessellate"},
    {"resampletoimage voxelize togrid rasterize", "-f resample"},
    {"plotoverline overline sampleline lineprobe plot chart graph lineplot", "-f probe_at"},
    {"integratevariables integral area", "-f integrate"},
    {"volume dvr raycast raycasting volumerender volumerendering", "--show volume"},
    {"mip maximumintensity maximumintensityprojection maximumprojection", "--show 'volume mode=maximum'"},
    {"vorticity rot rotation", "-f curl"},
    {"qcriterion q lambda2 swirl vortices", "-f vortex_measures"},
    {"cores vortexcorelines", "-f vortex_cores"},
    {"merge groupdatasets appenddatasets combine join", "-f append"},
    {"surfacenormals normal computenormals", "-f normals"},
    {"smoothing laplacian taubin", "-f smooth"},
    {"featureangle sharpedges", "-f feature_edges"},
    {"cellquality meshquality", "-f quality"},
    {"pointdatatocelldata pointtocelldata", "-f point_to_cell"},
    {"celldatatopointdata celltopointdata", "-f cell_to_point"},
    {"stats describe summary minmax range", "-f statistics"},
    {"hist distribution", "-f histogram"},
    {"blur gaussian denoise", "-f gaussian_smooth"},
    {"label labels annotate text", "--show labels"},
    {"vonmises mises tresca", "-f stress_measures"},
    {"fa fractionalanisotropy anisotropy", "-f tensor_measures"},
    {"fibers fibres tracts fibertracking", "-f tractography"},
    {"ellipsoids superquadrics tensorglyph", "-f tensor_glyphs"},
    {"convolution lineintegralconvolution surfacelic", "-f lic"},
    {"colormap colourmap lut palette cmap", "--map NAME"},
    {"colorbar colourbar scalarbar legend", "--legend \"title='...' unit=...\""},
    {"title background size axes", "--picture"},
    {"caption", "--picture \"caption='...'\""},
    {"textannotation", "--note 'Inlet @ 0.1,0.9'"},
    {"scalebar ruler", "--picture scale_bar=true"},
    {"view zoom orbit azimuth", "--camera"},
    {"opacity transparency transparent translucent alpha", "--show 'surface opacity=0.4'"},
    {"transferfunction opacityfunction colortransferfunction", "--show 'volume opacity=0:0,0.3:0.1,1:0.8'"},
    {"clim colorrange window windowlevel", "--show 'surface range=...'"},
    {"logscale log logarithmic", "--show 'surface scale=log'"},
    {"below above outofrange", "--show 'surface below=blue above=red'"},
};

}  // namespace

std::span<const OtherName> other_names() { return names; }

std::string said_here(std::string_view name, std::span<const std::string> candidates) {
  std::string plain = to_lower(name);
  std::erase_if(plain, [](char c) { return c == '_' || c == '-' || c == ' '; });
  for (const OtherName& n : names)
    for (const std::string_view word : words(n.words))
      if (word == plain) return fmt::format("here it is said {}", n.here);
  return unknown_name_hint(name, candidates);
}

}  // namespace sg
