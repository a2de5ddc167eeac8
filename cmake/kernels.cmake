# src/kernels is compiled once per instruction set.
