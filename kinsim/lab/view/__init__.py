"""The page of the lab, in Panel and Bokeh; all that it shows is made by the modules beside this folder."""
