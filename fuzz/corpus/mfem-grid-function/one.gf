@@ a.gf
FiniteElementSpace
FiniteElementCollection: H1_2D_P1
VDim: 1
Ordering: 0

1
2
3
4
5

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
2
1 0
0 0
1 1
0 1
1 2
