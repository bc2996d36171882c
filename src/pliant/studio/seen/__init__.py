"""What pages see of a scene: the mesh as drawn, its colours, the document, what there is to choose."""
