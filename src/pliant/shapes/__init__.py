"""Constructive modelling: primitives, booleans, and deformations anywhere in the tree."""

from pliant.shapes.primitives import box as box
from pliant.shapes.primitives import cone as cone
from pliant.shapes.primitives import cylinder as cylinder
from pliant.shapes.primitives import solid as solid
from pliant.shapes.primitives import sphere as sphere
from pliant.shapes.primitives import superquadric as superquadric
from pliant.shapes.primitives import torus as torus
from pliant.shapes.tree import Solid as Solid
