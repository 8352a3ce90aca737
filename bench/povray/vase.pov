// SPDX-License-Identifier: MIT
// Geometry, lights and camera of scenes/vase.txt.
#include "common.inc"
#declare Ambient = <0.16, 0.17, 0.19>;
LensCamera(<0.1, 2.5, 7.2>, <0.03, -0.232, -1>, 28, 0.06, 6.5)
DiscLight(<-4.2, 4.4, 3.4>, <0.75, -0.55, -0.4>, 0.8, <1.5, 1.4, 1.22>, 0.006)
DiscLight(<4, 3.6, 5>, <-0.6, -0.4, -0.65>, 1.5, <0.13, 0.14, 0.17>, 0)
background { rgb <0.05, 0.06, 0.07> }

#macro Paint(Colour) texture { pigment { rgb Colour } finish { ambient Ambient diffuse 1 } } #end
#declare Floor = texture { Picture("floor.png", 5, 5) finish { ambient Ambient diffuse 1 reflection 0.06 } }
    texture { pigment { rgb <0.9, 0.86, 0.82> filter 1 } finish { TintFinish } }
#declare Wall = texture { Picture("wall.png", 5.5, 3.3) finish { ambient Ambient diffuse 1 } }
    texture { pigment { rgb <0.72, 0.76, 0.78> filter 1 } finish { TintFinish } }
#declare Skirting = Paint(<0.62, 0.6, 0.56>)
#declare Room = Paint(<0.5, 0.46, 0.42>)
#declare Pane = texture { pigment { rgb 1 } finish { ambient Ambient * <21, 21.5, 22> diffuse 0 } }
Square(<-5, 0, 9>, <10, 0, 0>, <0, 0, -12>, Floor)
Square(<-5, 0, -3>, <10, 0, 0>, <0, 6, 0>, Wall)
Square(<-5, 0, -2.95>, <10, 0, 0>, <0, 0.34, 0>, Skirting)
Square(<-5, 0.34, -2.95>, <10, 0, 0>, <0, 0.03, -0.05>, Skirting)
Square(<-5, 0, 9>, <0, 0, -12>, <0, 6, 0>, Room)
Square(<5, 0, -3>, <0, 0, 12>, <0, 6, 0>, Room)
Square(<5, 0, 9>, <-10, 0, 0>, <0, 6, 0>, Room)
Square(<-5, 6, -3>, <10, 0, 0>, <0, 0, 12>, Room)
Square(<-4.95, 2.9, 4.7>, <0, 0, -1.2>, <0, 1.4, 0>, Pane)
Square(<-4.95, 2.9, 3.4>, <0, 0, -1.2>, <0, 1.4, 0>, Pane)
Square(<-4.95, 4.4, 4.7>, <0, 0, -1.2>, <0, 1.4, 0>, Pane)
Square(<-4.95, 4.4, 3.4>, <0, 0, -1.2>, <0, 1.4, 0>, Pane)

// The profile's eight cubic pieces, each with its four points. Its height is 2.11, about 2.105 of it reached.
lathe {
    bezier_spline 32
    <0, 0.03>, <0.14, 0.03>, <0.28, 0.03>, <0.38, 0>,
    <0.38, 0>, <0.46, 0>, <0.45, 0.08>, <0.44, 0.14>,
    <0.44, 0.14>, <0.40, 0.34>, <0.78, 0.6>, <0.79, 1.06>,
    <0.79, 1.06>, <0.80, 1.5>, <0.31, 1.5>, <0.285, 1.78>,
    <0.285, 1.78>, <0.27, 1.92>, <0.34, 2.03>, <0.44, 2.08>,
    <0.44, 2.08>, <0.485, 2.11>, <0.43, 2.15>, <0.38, 2.09>,
    <0.38, 2.09>, <0.27, 2.0>, <0.22, 1.92>, <0.24, 1.7>,
    <0.24, 1.7>, <0.25, 1.45>, <0.7, 1.5>, <0.7, 1.06>
    texture {
        pigment { image_map { png "porcelain.png" gamma srgb map_type 2 interpolate 2 } scale <-1, 2.11, 1> }
        finish { ambient Ambient * 0.95 diffuse 0.95 phong 0.25 phong_size 60 reflection 0.07 }
    }
    rotate 12 * y translate -0.2 * x
}
sphere { <1.28, 0.48, -0.75>, 0.48 texture { pigment { rgb <0.02, 0.02, 0.02> } finish { ambient Ambient diffuse 1 reflection <0.86, 0.87, 0.88> } } }
GlassBall(<-0.8, 0.32, 1.45>, 0.32, <0.86, 0.9, 0.89>, 0.09, 0)
object { Globe(0.34, 2, Ambient * <0.1, 0.26, 0.55>) translate <1.12, 0.34, 0.95> }
sphere { <0.18, 0.15, 1.95>, 0.15 texture { pigment { rgb <0.7, 0.06, 0.04> } finish { ambient Ambient diffuse 1 phong 0.4 phong_size 70 } } }
