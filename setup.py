"""What pyproject.toml cannot say: both packages as they are found, and data/ as casingfem/data of the wheel."""

from setuptools import find_packages, setup

setup(packages=[*find_packages(include=["casingfem*", "contact*"]), "casingfem.data"])
