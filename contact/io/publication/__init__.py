"""Replace a set of files: write the new set beside the old one, announce it by a manifest, then move it into place.

A writer fills a staging folder, with an unguessable name, in the folder of the set. It states the names, sizes
and checksums of all files in a manifest, and announces it under one fixed name (`MANIFEST`), which only one writer can
have at a time. From then on the set can be finished from its staging folder: the files that it replaces are moved away,
into the staging folder, before the first new one takes its place. In the end the manifest and the staging folder go.

A reader that meets a manifest knows that the set beside it may be incomplete (`reading.py`). It changes nothing.
Where the writer was killed, `recovery.py` finishes the set, or puts the old files back where a new one is damaged.
Links are never followed inside the folder, and only files that the manifest names are touched.
"""
