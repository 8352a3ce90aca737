#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# usage: mesh.py MESH.obj     the mesh as POV-Ray's mesh2, with the normals that our `normals smooth` gives: the mean of
# those of the faces around a vertex.
import math, sys

positions, faces = [], []
for line in open(sys.argv[1]):
    word = line.split()
    if word[:1] == ["v"]:
        positions.append(tuple(map(float, word[1:4])))
    elif word[:1] == ["f"]:
        faces.append([int(w.split("/")[0]) - 1 for w in word[1:4]])

normals = [[0.0, 0.0, 0.0] for _ in positions]
for face in faces:
    a, b, c = (positions[i] for i in face)
    u, v = [[q - p for p, q in zip(a, other)] for other in (b, c)]
    n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
    length = math.sqrt(sum(x * x for x in n)) or 1.0
    for i in face:
        for axis in range(3):
            normals[i][axis] += n[axis] / length


def block(name, rows, form):
    return "%s { %d, %s }" % (name, len(rows), ", ".join(form % tuple(r) for r in rows))


print("#declare BunnyMesh = mesh2 {")
print(block("vertex_vectors", positions, "<%.9g, %.9g, %.9g>"))
print(block("normal_vectors", normals, "<%.9g, %.9g, %.9g>"))
print(block("face_indices", faces, "<%d, %d, %d>"))
print("}")
