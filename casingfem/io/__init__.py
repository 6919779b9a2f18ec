"""Files: strict CSV, npz arrays, mesh files with includes, workbooks, readers in child processes."""
