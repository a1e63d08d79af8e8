#version 430 core
// Of solid surfaces: depth is all there is.

void main() {}
