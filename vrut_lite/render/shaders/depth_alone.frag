#version 430 core
// Depth of opaque surfaces, without colour.

void main() {}
