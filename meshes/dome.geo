// A rubber dome: a round pad of 10 mm radius and 6 mm height whose upper face is bowed by 1 mm, bonded below. Hexahedra: a square in
// the middle, four blocks around it. Lengths in m; z is upward.
//
//   gmsh -3 -format msh41 -bin dome.geo -o dome.msh
//
// -setnumber n 2 halves the cells everywhere.

DefineConstant[ n = 1, radius = 0.01, height = 0.005, bow = 0.001, core = 0.55 ];

along = 6 * n;     // cells of a side of the square
out = 4 * n;       // from it to the rim
down = 4 * n;      // through the height
// The sphere through the rim and the summit: its radius, and how high its points are at a distance r from the axis.
ball = (radius^2 + bow^2) / (2 * bow);
r = core * radius;
top = height + bow;
shoulder = top - ball + Sqrt(ball^2 - r^2);
a = r / Sqrt(2);
b = radius / Sqrt(2);

Point(1) = {0, 0, 0};
Point(2) = {0, 0, top - ball};
For k In {0 : 3}
  x = (k == 0 || k == 3) ? -1 : 1;
  y = (k < 2) ? -1 : 1;
  Point(11 + k) = {x * a, y * a, 0};
  Point(21 + k) = {x * b, y * b, 0};
  Point(31 + k) = {x * a, y * a, shoulder};
  Point(41 + k) = {x * b, y * b, height};
EndFor
Point(3) = {0, 0, height};
For k In {0 : 3}
  m = (k + 1) % 4;
  Line(101 + k) = {11 + k, 11 + m};
  Circle(111 + k) = {21 + k, 1, 21 + m};
  Line(121 + k) = {11 + k, 21 + k};
  Circle(131 + k) = {31 + k, 2, 31 + m};
  Circle(141 + k) = {41 + k, 3, 41 + m};
  Circle(151 + k) = {31 + k, 2, 41 + k};
  Line(161 + k) = {11 + k, 31 + k};
  Line(171 + k) = {21 + k, 41 + k};
  Transfinite Curve {101 + k, 111 + k, 131 + k, 141 + k} = along + 1;
  Transfinite Curve {121 + k, 151 + k} = out + 1;
  Transfinite Curve {161 + k, 171 + k} = down + 1;
EndFor
Curve Loop(1) = {101, 102, 103, 104};
Plane Surface(1) = {1};
Curve Loop(2) = {131, 132, 133, 134};
Surface(2) = {2} In Sphere {2};
For k In {0 : 3}
  m = (k + 1) % 4;
  Curve Loop(11 + k) = {101 + k, 121 + m, -(111 + k), -(121 + k)};
  Plane Surface(11 + k) = {11 + k};
  Curve Loop(21 + k) = {131 + k, 151 + m, -(141 + k), -(151 + k)};
  Surface(21 + k) = {21 + k} In Sphere {2};
  Curve Loop(31 + k) = {101 + k, 161 + m, -(131 + k), -(161 + k)};
  Surface(31 + k) = {31 + k};
  Curve Loop(41 + k) = {111 + k, 171 + m, -(141 + k), -(171 + k)};
  Surface(41 + k) = {41 + k};
  Curve Loop(51 + k) = {121 + k, 171 + k, -(151 + k), -(161 + k)};
  Plane Surface(51 + k) = {51 + k};
EndFor
Surface Loop(1) = {1, 2, 31, 32, 33, 34};
Volume(1) = {1};
For k In {0 : 3}
  m = (k + 1) % 4;
  Surface Loop(11 + k) = {11 + k, 21 + k, 31 + k, 41 + k, 51 + k, 51 + m};
  Volume(11 + k) = {11 + k};
EndFor
Transfinite Surface "*";
Recombine Surface "*";
Transfinite Volume "*";

Physical Surface("contact") = {2, 21, 22, 23, 24};
Physical Surface("base") = {1, 11, 12, 13, 14};
Physical Volume("rubber") = {1, 11, 12, 13, 14};
