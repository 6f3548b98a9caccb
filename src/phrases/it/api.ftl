# The page that describes the interface for programs; what is in it is English in every language.

api-title = Per i programmi
api-about = Che cosa i programmi possono chiedere a hallsweep, e che cosa ricevono; per i generatori di client:
api-subjects = Argomenti
api-shapes = Forme
api-for = Per
api-name = Nome
api-body = Corpo
api-answer = Risposta
api-problems = Che cosa può andare storto
