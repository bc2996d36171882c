"""Parts from CAD, deformed as what they are: a parametric surface stays parametric."""

from pliant.cad.files import read as read
from pliant.cad.files import write as write
from pliant.cad.part import Part as Part
