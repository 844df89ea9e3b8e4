// SPDX-License-Identifier: Apache-2.0
#include "scene/show/other_names.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "base/text/text.h"

namespace sg {

namespace {

constexpr OtherName names[] = {
    {"contour isosurface isosurfaces iso isocontour isovalue marchingcubes marchingsquares flyingedges flyingedges3d contours contour3d "
     "levelset",
     "-f 'contour values=...'"},
    {"isolines contourlines isoline levels", "-f 'isolines count=10'"},
    {"filledcontours bandedcontour contourf contourbanded bandedpolydatacontour", "-f 'bands count=10'"},
    {"slice cut cutter cutplane plane planecutter section slices crosssection orthoslice sliceimplicit", "-f 'slice axis=z'"},
    {"sliceorthogonal orthogonalslices threeslices", "-f 'slice planes=xyz'"},
    {"slicealongaxis parallelslices", "-f 'slice axis=z positions=...'"},
    {"clip halfspace cutaway clipplane clipdataset clippolydata tablebasedclipdataset", "-f 'clip axis=z'"},
    {"clipbox boxclip boxclipdataset extractbox", "-f 'clip box=...'"},
    {"clipscalar clipbyscalar", "-f 'clip value=...'"},
    {"clipsurface selectenclosedpoints selectinteriorpoints enclosedpoints boolean booleanoperation booleandifference booleanintersection",
     "-f 'clip with=...'"},
    {"intersection intersectionpolydata surfaceintersection", "-f 'slice with=...'"},
    {"glyph arrow arrows quiver quivers vectors hedgehog glyph3d glyph2d glyph3dmapper", "--show glyphs"},
    {"streamlines streamline streamtracer stream flowlines fieldlines integralcurves streamlinesfromsource", "-f streamlines"},
    {"streamlinesevenlyspaced2d evenlyspacedstreamlines2d evenlyspacedstreamlines", "-f even_streamlines"},
    {"pathline particletracer trajectories", "-f pathlines"},
    {"tubes tube", "-f tubes"},
    {"ribbon", "-f ribbons"},
    {"wireframe wire mesh gridlines", "--show 'surface style=wireframe'"},
    {"edges grid", "--show 'surface edges=true'"},
    {"outline outlinecorners boundingbox box bounds frame", "--show outline"},
    {"points pointcloud scatter scatterplot vertices dots point vertexglyph", "--show points"},
    {"surface solid shaded", "--show surface"},
    {"extractalledges extractedges alledges", "-f 'feature_edges manifold=true'"},
    {"extractsurface extractgeometry skin boundary outersurface externalfaces geometry datasetsurface hull", "-f faces"},
    {"connectivity connectedcomponents regions islands polydataconnectivity splitbodies bodies", "-f components"},
    {"extractlargest largest largestregion", "-f 'components keep=1'"},
    {"labelconnectivity imageconnectivity sortlabels packlabels", "-f label_components"},
    {"contourlabels contourlabeled discretemarchingcubes discreteflyingedges3d surfacenets surfacenets3d", "-f label_surface"},
    {"subset extractsubset voi subvolume extractvoi extractgrid", "-f crop"},
    {"calculator arraycalculator pythoncalculator programmable expression formula math", "-f 'calc expr=...'"},
    {"height", "-f elevation"},
    {"texturemap texturemaptoplane texturemaptosphere texturemaptocylinder texturecoordinates tcoords uvmap uv", "-f texture_coordinates"},
    {"texture decal", "--show 'surface picture=FILE.png'"},
    {"linearextrusion extrusion", "-f 'extrude direction=0,0,1'"},
    {"warpbyvector warpbyscalar warpvector warpscalar deform displace displacement terrain relief", "-f warp"},
    {"reflect reflection symmetry axisalignedreflection", "-f 'mirror axis=x'"},
    {"flip flipx flipy flipz", "-f 'transform scale=-1,1,1'"},
    {"exaggeration verticalexaggeration zscale aspect", "--picture stretch=1,1,10"},
    {"rotate rotatex rotatey rotatez rotatevector translate move rescale transformpolydata", "-f transform"},
    {"linearize nonlinearsubdivision", "-f tessellate"},
    {"resampletoimage voxelize voxelizebinarymask voxelmodeller togrid rasterize", "-f resample"},
    {"sample resamplewithdataset interpolatefrom", "-f 'probe with=...'"},
    {"plotoverline overline sampleline sampleoverline lineprobe plot chart graph lineplot", "-f probe_at"},
    {"sampleovercirculararc plotovercirculararc sampleovermultiplelines", "-f 'probe_at points=...'"},
    {"integratevariables integrateattributes integratedata integral area arclength computearclength", "-f integrate"},
    {"massproperties centerofmass centroid enclosedvolume", "-f mass_properties"},
    {"computecellsizes cellsizes cellsize cellvolumes cellareas", "-f 'quality measures=size'"},
    {"curvatures plotcurvature", "-f curvature"},
    {"computederivatives computederivative derivatives derivative cellderivatives", "-f gradient"},
    {"vectornorm vectormagnitude norm", "-f magnitude"},
    {"volume dvr raycast raycasting volumerender volumerendering", "--show volume"},
    {"mip maximumintensity maximumintensityprojection maximumprojection", "--show 'volume mode=maximum'"},
    {"vorticity rot rotation", "-f curl"},
    {"qcriterion q lambda2 swirl vortices", "-f vortex_measures"},
    {"cores vortexcorelines", "-f vortex_cores"},
    {"merge groupdatasets appenddatasets appendpolydata combine concatenate join", "-f append"},
    {"surfacenormals normal computenormals polydatanormals", "-f normals"},
    {"flipnormals flipfaces reversesense", "-f 'normals flip=true'"},
    {"fillholes closeholes", "-f cap"},
    {"cleanpolydata staticcleanpolydata cleangrid cleantogrid removeunusedpoints removeduplicates", "-f clean"},
    {"cellcenters cellcentres centers centres", "-f 'glyph_points mode=cells'"},
    {"maskpoints randompoints subsamplepoints", "-f 'glyph_points mode=random'"},
    {"strip stripper joinlines", "-f polylines"},
    {"casttounstructuredgrid tounstructured", "-f unstructured"},
    {"extractcells extractpoints extractselection extractcellsbytype selection", "-f extract"},
    {"extractblock extractblocks multiblockblock", "-f 'extract blocks=...'"},
    {"thresholdpercent selectvalues extractvalues splitvalues imagethreshold", "-f threshold"},
    {"imagedilateerode dilate erode dilation erosion opening closing", "-f morphology"},
    {"distancetransform imageeuclideandistance", "-f distance_map"},
    {"tabletopolydata tabletopoints tabletostructuredgrid", "-f table_to_points"},
    {"smoothing laplacian taubin smoothtaubin smoothpolydata windowedsinc windowedsincpolydata smoothmesh", "-f smooth"},
    {"featureangle sharpedges extractfeatureedges boundaryedges", "-f feature_edges"},
    {"cellquality meshquality computecellquality", "-f quality"},
    {"pointdatatocelldata pointtocelldata ptc", "-f point_to_cell"},
    {"celldatatopointdata celltopointdata ctp", "-f cell_to_point"},
    {"stats describe summary minmax range descriptivestatistics", "-f statistics"},
    {"hist distribution extracthistogram", "-f histogram"},
    {"blur gaussian gaussiansmoothing imagegaussiansmooth denoise", "-f gaussian_smooth"},
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

// As the tables hold it; behind it without what class names of VTK have around it.
std::vector<std::string> plain_forms(std::string_view name) {
  std::string plain = to_lower(name);
  std::erase_if(plain, [](char c) { return c == '_' || c == '-' || c == ' '; });
  std::vector<std::string> forms = {plain};
  std::string_view bare = plain;
  constexpr std::string_view prefix = "vtk", suffix = "filter";
  if (bare.starts_with(prefix)) bare.remove_prefix(prefix.size()), forms.emplace_back(bare);
  if (bare.size() > suffix.size() && bare.ends_with(suffix)) forms.emplace_back(bare.substr(0, bare.size() - suffix.size()));
  return forms;
}

}  // namespace

std::span<const OtherName> other_names() { return names; }

std::string known_elsewhere(std::string_view name) {
  for (const std::string& plain : plain_forms(name)) {
    for (const OtherName& n : names)
      for (const std::string_view word : words(n.words))
        if (word == plain) return fmt::format("here it is said {}", n.here);
    for (const MissingName& n : missing_names())
      for (const std::string_view word : words(n.words))
        if (word == plain)
          return fmt::format("there is no operation that {}{}", n.what, n.nearest.empty() ? "" : fmt::format("; nearest: {}", n.nearest));
  }
  return "";
}

std::string said_here(std::string_view name, std::span<const std::string> candidates) {
  if (const std::string said = known_elsewhere(name); !said.empty()) return said;
  for (const std::string& plain : plain_forms(name))
    for (const std::string& candidate : candidates)
      if (plain_forms(candidate)[0] == plain) return fmt::format("here it is called {}", candidate);
  return unknown_name_hint(name, candidates);
}

}  // namespace sg
