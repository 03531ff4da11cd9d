// A piece of a photovoltaic laminate, 60 mm wide: glass over an encapsulant in which two cells of silicon lie side by side,
// with a gap between them. Lengths in m; the contact face is that of the glass, the lower side is clamped.
//
//   gmsh -2 -format msh41 laminate.geo -o laminate.msh
//
// -setnumber n 2 halves the cells everywhere.

DefineConstant[ n = 1 ];

// Columns: cell, gap, cell. Rows, from below: encapsulant, silicon (and the gap), encapsulant, glass.
x[] = {0, 0.028, 0.032, 0.06};
z[] = {-0.0040, -0.0036, -0.0034, -0.0030, 0};
along[] = {56 * n, 8 * n, 56 * n};
through[] = {3 * n, 2 * n, 3 * n, 10 * n};

For j In {0 : 4}
  For i In {0 : 3}
    Point(1 + i + 4 * j) = {x[i], z[j], 0};
  EndFor
EndFor
For j In {0 : 4}
  For i In {0 : 2}
    Line(101 + i + 3 * j) = {1 + i + 4 * j, 2 + i + 4 * j};
    Transfinite Curve {101 + i + 3 * j} = along[i] + 1;
  EndFor
EndFor
For j In {0 : 3}
  For i In {0 : 3}
    Line(201 + i + 4 * j) = {1 + i + 4 * j, 5 + i + 4 * j};
    Transfinite Curve {201 + i + 4 * j} = through[j] + 1;
  EndFor
EndFor
For j In {0 : 3}
  For i In {0 : 2}
    k = 1 + i + 3 * j;
    Curve Loop(k) = {100 + k, 202 + i + 4 * j, -(103 + k), -(201 + i + 4 * j)};
    Plane Surface(k) = {k};
  EndFor
EndFor
Transfinite Surface {1 : 12};
Recombine Surface {1 : 12};

Physical Curve("contact") = {113, 114, 115};
Physical Curve("base") = {101, 102, 103};
Physical Curve("sides") = {201, 204, 205, 208, 209, 212, 213, 216};
Physical Surface("glass") = {10, 11, 12};
Physical Surface("encapsulant") = {1, 2, 3, 5, 7, 8, 9};
Physical Surface("silicon") = {4, 6};
