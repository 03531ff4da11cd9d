// A half disk under a small contact: flat face up, centre of the face at the origin, lengths in m.
// Quadrilaterals only: a box of square cells under the contact, and three blocks that grow from it to the arc.
//
//   gmsh -2 -format msh41 half_disk.geo -o half_disk.msh
//
// -setnumber n 2 halves the cells everywhere (3 and so on likewise).
//
// half_plane.msh, whose arc is so far that it does not matter:
//
//   gmsh -2 -format msh41 half_disk.geo -setnumber radius 100 -setnumber out 44 -o half_plane.msh

DefineConstant[
  n = 1,          // refinement
  radius = 5.0,   // of the half disk
  width = 0.03,   // half the width of the box
  depth = 0.024,  // of the box
  out = 30 * n    // cells from the box to the arc
];

along = 40 * n;   // cells of the box along the face (even)
down = 16 * n;    // and down
growth = 1.24 ^ (1 / n);
angle = 40 * Pi / 180;   // of the arc that belongs to a side of the box

Point(1) = {-width, 0, 0};
Point(2) = {width, 0, 0};
Point(3) = {width, -depth, 0};
Point(4) = {-width, -depth, 0};
Point(5) = {-radius, 0, 0};
Point(6) = {radius, 0, 0};
Point(7) = {radius * Cos(angle), -radius * Sin(angle), 0};
Point(8) = {-radius * Cos(angle), -radius * Sin(angle), 0};
Point(9) = {0, 0, 0};

Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Line(5) = {1, 5};
Line(6) = {2, 6};
Line(7) = {3, 7};
Line(8) = {4, 8};
Circle(9) = {5, 9, 8};
Circle(10) = {8, 9, 7};
Circle(11) = {7, 9, 6};

Curve Loop(1) = {1, 2, 3, 4};
Curve Loop(2) = {-4, 8, -9, -5};
Curve Loop(3) = {-3, 7, -10, -8};
Curve Loop(4) = {-2, 6, -11, -7};
Plane Surface(1) = {1};
Plane Surface(2) = {2};
Plane Surface(3) = {3};
Plane Surface(4) = {4};

Transfinite Curve {1, 3, 10} = along + 1;
Transfinite Curve {2, 4, 9, 11} = down + 1;
Transfinite Curve {5, 6, 7, 8} = out + 1 Using Progression growth;
Transfinite Surface {1, 2, 3, 4};
Recombine Surface {1, 2, 3, 4};

Physical Curve("contact") = {5, 1, 6};
Physical Curve("base") = {9, 10, 11};
Physical Surface("disk") = {1, 2, 3, 4};
