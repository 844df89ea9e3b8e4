// SPDX-License-Identifier: Apache-2.0
// The reading and writing functions of every format: one .cpp per format, bodies there.
#pragma once
#include "io/io.h"

namespace sg {

bool sniff_vtk_legacy(std::span<const std::byte> head);
Data read_vtk_legacy(const std::string& path, const ReadOptions& options, Context& context);

bool sniff_vtk_xml(std::span<const std::byte> head);
Data read_vtk_xml(const std::string& path, const ReadOptions& options, Context& context);
void write_vtk_xml(const std::string& path, const Data& data, const WriteOptions& options, Context& context);

bool sniff_nrrd(std::span<const std::byte> head);
Data read_nrrd(const std::string& path, const ReadOptions& options, Context& context);
void write_nrrd(const std::string& path, const Data& data, const WriteOptions& options, Context& context);

bool sniff_metaimage(std::span<const std::byte> head);
Data read_metaimage(const std::string& path, const ReadOptions& options, Context& context);
void write_metaimage(const std::string& path, const Data& data, const WriteOptions& options, Context& context);

Data read_raw(const std::string& path, const ReadOptions& options, Context& context);

bool sniff_ply(std::span<const std::byte> head);
Data read_ply(const std::string& path, const ReadOptions& options, Context& context);
void write_ply(const std::string& path, const Data& data, const WriteOptions& options, Context& context);

Data read_stl(const std::string& path, const ReadOptions& options, Context& context);
void write_stl(const std::string& path, const Data& data, const WriteOptions& options, Context& context);

Data read_obj(const std::string& path, const ReadOptions& options, Context& context);
void write_obj(const std::string& path, const Data& data, const WriteOptions& options, Context& context);

Data read_csv(const std::string& path, const ReadOptions& options, Context& context);
void write_csv(const std::string& path, const Data& data, const WriteOptions& options, Context& context);

// Of files whose name says nothing (Format::recognize).
bool looks_like_stl(std::span<const std::byte> whole);
bool looks_like_obj(std::span<const std::byte> whole);
bool looks_like_csv(std::span<const std::byte> whole);
bool looks_like_json(std::span<const std::byte> whole);
bool looks_like_gltf(std::span<const std::byte> whole);

bool sniff_geojson(std::span<const std::byte> head);
bool sniff_whole_geojson(std::span<const std::byte> whole);
Data read_geojson(const std::string& path, const ReadOptions& options, Context& context);

Data read_json(const std::string& path, const ReadOptions& options, Context& context);
bool sniff_nifti(std::span<const std::byte> head);
Data read_nifti(const std::string& path, const ReadOptions& options, Context& context);
std::vector<double> times_of_nifti(const std::string& path, const ReadOptions& options, Context& context);
void write_nifti(const std::string& path, const Data& data, const WriteOptions& options, Context& context);

void write_analyze(const std::string& path, const Data& data, const WriteOptions& options, Context& context);
void write_dicom(const std::string& path, const Data& data, const WriteOptions& options, Context& context);

bool sniff_npy(std::span<const std::byte> head);
Data read_npy(const std::string& path, const ReadOptions& options, Context& context);
void write_npy(const std::string& path, const Data& data, const WriteOptions& options, Context& context);

bool sniff_slc(std::span<const std::byte> head);
Data read_slc(const std::string& path, const ReadOptions& options, Context& context);

Data read_cube(const std::string& path, const ReadOptions& options, Context& context);

bool sniff_dicom(std::span<const std::byte> head);
bool sniff_dicom_folder(const std::string& path);

bool sniff_vdb(std::span<const std::byte> head);
bool sniff_mfem_mesh(std::span<const std::byte> head);
bool sniff_mfem_function(std::span<const std::byte> head);
bool sniff_glvis(std::span<const std::byte> head);
Data read_mfem_mesh(const std::string& path, const ReadOptions& options, Context& context);
Data read_mfem_function(const std::string& path, const ReadOptions& options, Context& context);
Data read_glvis(const std::string& path, const ReadOptions& options, Context& context);

bool sniff_gmsh(std::span<const std::byte> head);
Data read_gmsh(const std::string& path, const ReadOptions& options, Context& context);
std::vector<double> times_of_gmsh(const std::string& path, const ReadOptions& options, Context& context);

bool sniff_off(std::span<const std::byte> head);
Data read_off(const std::string& path, const ReadOptions& options, Context& context);

bool sniff_ucd(std::span<const std::byte> head);
Data read_ucd(const std::string& path, const ReadOptions& options, Context& context);

bool sniff_tecplot(std::span<const std::byte> head);
Data read_tecplot(const std::string& path, const ReadOptions& options, Context& context);
std::vector<double> times_of_tecplot(const std::string& path, const ReadOptions& options, Context& context);

bool sniff_gambit(std::span<const std::byte> head);
Data read_gambit(const std::string& path, const ReadOptions& options, Context& context);

bool sniff_nek5000(std::span<const std::byte> head);
Data read_nek5000(const std::string& path, const ReadOptions& options, Context& context);
std::vector<double> times_of_nek5000(const std::string& path, const ReadOptions& options, Context& context);
bool sniff_ensight(std::span<const std::byte> head);
Data read_ensight(const std::string& path, const ReadOptions& options, Context& context);
std::vector<double> times_ensight(const std::string& path, const ReadOptions& options, Context& context);
bool sniff_ensight_servers(std::span<const std::byte> head);
Data read_ensight_servers(const std::string& path, const ReadOptions& options, Context& context);
std::vector<double> times_ensight_servers(const std::string& path, const ReadOptions& options, Context& context);

bool sniff_plot3d(std::span<const std::byte> whole);
Data read_plot3d(const std::string& path, const ReadOptions& options, Context& context);
bool sniff_plot3d_meta(std::span<const std::byte> head);
Data read_plot3d_meta(const std::string& path, const ReadOptions& options, Context& context);
std::vector<double> times_plot3d_meta(const std::string& path, const ReadOptions& options, Context& context);

bool sniff_amrex_folder(const std::string& path);
Data read_amrex(const std::string& path, const ReadOptions& options, Context& context);
std::vector<double> times_amrex(const std::string& path, const ReadOptions& options, Context& context);

bool sniff_bov(std::span<const std::byte> head);
Data read_bov(const std::string& path, const ReadOptions& options, Context& context);
Data read_bare_bov(const std::string& path, const ReadOptions& options, Context& context);

bool sniff_openfoam_folder(const std::string& path);
bool sniff_openfoam_control(std::span<const std::byte> head);
Data read_openfoam(const std::string& path, const ReadOptions& options, Context& context);
std::vector<double> times_openfoam(const std::string& path, const ReadOptions& options, Context& context);
bool sniff_vtk_parallel(std::span<const std::byte> head);
Data read_vtk_parallel(const std::string& path, const ReadOptions& options, Context& context);
/// *.pvti *.pvtr *.pvts *.pvtu *.pvtp: the datasets of a collection are the pieces of one mesh (or a mesh is the only piece). Pieces go
/// into a folder of the file's name without its extension. Throws Error(usage) for grids that are not boxes of one grid.
void write_vtk_parallel(const std::string& path, const Data& data, const WriteOptions& options, Context& context);
bool sniff_vtk_multiblock(std::span<const std::byte> head);
Data read_vtk_multiblock(const std::string& path, const ReadOptions& options, Context& context);
/// Parts go into a folder of the file's name without its extension.
void write_vtk_multiblock(const std::string& path, const Data& data, const WriteOptions& options, Context& context);
bool sniff_pvd(std::span<const std::byte> head);
Data read_pvd(const std::string& path, const ReadOptions& options, Context& context);
std::vector<double> times_of_pvd(const std::string& path, const ReadOptions& options, Context& context);
/// Steps go into a folder of the file's name without its extension.
void write_pvd(const std::string& path, const Data& data, const WriteOptions& options, Context& context);
std::unique_ptr<StepsWriter> write_pvd_steps(const std::string& path, StepsPlan plan, const WriteOptions& options, Context& context);

bool sniff_file_series(std::span<const std::byte> head);
Data read_file_series(const std::string& path, const ReadOptions& options, Context& context);
std::vector<double> times_of_file_series(const std::string& path, const ReadOptions& options, Context& context);
bool sniff_vtk_amr(std::span<const std::byte> head);
Data read_vtk_amr(const std::string& path, const ReadOptions& options, Context& context);
/// Patches go into a folder of the file's name without its extension.
void write_vtk_amr(const std::string& path, const Data& data, const WriteOptions& options, Context& context);
bool sniff_hdf5(std::span<const std::byte> head);
bool sniff_enzo(std::span<const std::byte> head);

bool sniff_xdmf(std::span<const std::byte> head);
Data read_xdmf(const std::string& path, const ReadOptions& options, Context& context);
std::vector<double> times_of_xdmf(const std::string& path, const ReadOptions& options, Context& context);
bool sniff_minc_2(std::span<const std::byte> head);
bool sniff_netcdf(std::span<const std::byte> head);
bool sniff_cgns(std::span<const std::byte> head);

bool sniff_png(std::span<const std::byte> head);
bool sniff_jpeg(std::span<const std::byte> head);
bool sniff_tiff(std::span<const std::byte> head);
bool sniff_picture_folder(const std::string& path);
Data read_png_grid(const std::string& path, const ReadOptions& options, Context& context);
Data read_jpeg_grid(const std::string& path, const ReadOptions& options, Context& context);
Data read_picture_stack(const std::string& path, const ReadOptions& options, Context& context);
bool sniff_glb(std::span<const std::byte> head);
Data read_gltf(const std::string& path, const ReadOptions& options, Context& context);
void write_gltf(const std::string& path, const Data& data, const WriteOptions& options, Context& context);
Data read_bpt(const std::string& path, const ReadOptions& options, Context& context);
Data read_gml(const std::string& path, const ReadOptions& options, Context& context);

bool sniff_zarr_folder(const std::string& path);
Data read_zarr(const std::string& path, const ReadOptions& options, Context& context);
std::vector<double> times_of_zarr(const std::string& path, const ReadOptions& options, Context& context);
/// One point field of a uniform grid as OME-Zarr; see io/zarr/zarr.h.
void write_zarr(const std::string& path, const Data& data, const WriteOptions& options, Context& context);
/// The same with time as the first axis; steps lie at equal distances.
std::unique_ptr<StepsWriter> write_zarr_steps(const std::string& path, StepsPlan plan, const WriteOptions& options, Context& context);

}  // namespace sg
