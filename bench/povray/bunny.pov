// SPDX-License-Identifier: MIT
// Geometry, lights and camera of scenes/bunny.txt. render.sh writes bunny_mesh.inc.
#include "common.inc"
#include "bunny_mesh.inc"
#declare Ambient = <0.13, 0.13, 0.15>;
LensCamera(<0.15, 1.4, 5.6>, <-0.01, -0.125, -1>, 31, 0.11, 5.1)
DiscLight(<-3.3, 3.9, 4.9>, <0.62, -0.6, -0.9>, 0.8, <1.3, 1.2, 1.03>, 0.004)
background { rgb <0.30, 0.26, 0.22> }

#macro Plastic(Colour, Highlight, Size, Mirror)
texture { pigment { rgb Colour } finish { ambient Ambient diffuse 1 phong Highlight phong_size Size reflection Mirror } }
#end

#declare Floor = texture { Picture("floor.png", 7, 6) finish { ambient Ambient diffuse 1 reflection 0.07 } }
    texture { pigment { rgb <0.9, 0.86, 0.82> filter 1 } finish { TintFinish } }
#declare Wall = texture { Picture("wall.png", 7, 4) finish { ambient Ambient diffuse 1 } }
    texture { pigment { rgb <0.30, 0.42, 0.46> filter 1 } finish { TintFinish } }
Square(<-9, 0, 9>, <18, 0, 0>, <0, 0, -15.5>, Floor)
Square(<-9, 0, -6.5>, <18, 0, 0>, <0, 8, 0>, Wall)

object { BunnyMesh scale 1.75 rotate -15 * y translate 0.2 * x Plastic(<0.68, 0.46, 0.28>, 0.12, 25, 0.02) }
sphere { <1.75, 0.45, -2.6>, 0.45 Plastic(<0.75, 0.45, 0.04>, 0.5, 80, 0.06) }
GlassBall(<0.86, 0.3, 1.75>, 0.3, <0.88, 0.92, 0.9>, 0.08, 0.8)
object { Globe(0.36, 2.4, Ambient * <0.15, 0.4, 0.85>) translate <-1.22, 0.36, -0.6> }
sphere { <-0.62, 0.16, 1.55>, 0.16 Plastic(<0.7, 0.06, 0.04>, 0.5, 80, 0.06) }
sphere { <-1.9, 0.5, -3.6>, 0.5 Plastic(<0.10, 0.17, 0.60>, 0.5, 80, 0.06) }

#macro Lamp(At) sphere { At, 0.1 texture { pigment { rgb 1 } finish { ambient Ambient * <15, 10, 4.5> diffuse 0 } } } #end
Lamp(<-2.75, 2.75, -6>)
Lamp(<-2.1, 2.49, -6>)
Lamp(<-1.4, 2.35, -6>)
Lamp(<-0.7, 2.37, -6>)
Lamp(<0, 2.55, -6>)
Lamp(<0.7, 2.79, -6>)
Lamp(<1.3, 2.57, -6>)
Lamp(<1.95, 2.47, -6>)
Lamp(<2.6, 2.59, -6>)
