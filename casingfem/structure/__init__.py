"""Structures: charts, fields, supports, shells and their matrices."""
