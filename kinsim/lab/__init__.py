"""`kinsim lab`: watch the density move. The model of the page is here without the page; `view` holds the page."""
