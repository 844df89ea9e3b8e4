@@ a.gf
FiniteElementSpace
FiniteElementCollection: L2_T1_2D_P1
VDim: 2
Ordering: 1

0 1 2 3 4 5 6 7 8 9 10 11 12 13

@@ a.mesh
MFEM mesh v1.0

dimension
2

elements
2
3 3 1 0 2 3
4 2 3 2 4

boundary
1
1 1 0 1

vertices
5

nodes
FiniteElementSpace
FiniteElementCollection: L2_T1_2D_P1
VDim: 2
Ordering: 1

0 0 1 0 0 1 1 1 0 1 1 1 2 1
