"""What the module for 3D Slicer does that needs no Slicer: surfaces, plans, runs and motion.

Slicer's world is in RAS (x to the right, y to the front), Lipofill's in LPS; `surfaces` is where
one becomes the other, and nowhere else.
"""
